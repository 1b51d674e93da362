"""The loop: ask, evaluate, remember, tell."""
