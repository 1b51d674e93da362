"""Ask-and-tell searches; they know no robots."""
