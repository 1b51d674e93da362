"""`python -m evodesign.cli` is `evodesign`."""

from evodesign.cli.main import main

main()
