"""The log of a run: written, read, replayed."""
