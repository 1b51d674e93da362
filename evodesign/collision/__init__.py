"""How far bodies are apart that must not pass through each other."""
