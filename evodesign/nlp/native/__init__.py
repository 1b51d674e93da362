"""The interior-point method in C, over a program's compiled functions; IPOPT is its judge."""
