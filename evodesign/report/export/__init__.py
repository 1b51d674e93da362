"""A design as a folder of files that other tools open."""
