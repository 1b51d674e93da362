"""Our person beside people who were measured: in their postures, and in those that we predict."""
