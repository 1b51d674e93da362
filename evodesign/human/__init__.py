"""Bodies of people: generated from figures that were measured, with their strength."""
