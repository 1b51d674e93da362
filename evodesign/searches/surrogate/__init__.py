"""A search that learns a model of the objectives, from values and gradients, and evolves designs on it."""
