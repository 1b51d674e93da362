"""What a robot's file does not say and a problem needs, guessed from geometry with reasons; and its check."""
