"""Results as tables and text for people."""
