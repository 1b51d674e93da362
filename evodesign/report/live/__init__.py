"""A running search as a local page that refreshes itself."""
