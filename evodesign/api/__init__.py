"""evodesign from Python: runs as tables and designs, problems for other optimisers."""
