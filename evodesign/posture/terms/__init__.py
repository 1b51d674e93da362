"""Terms of the posture programs."""
