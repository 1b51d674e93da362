"""How postures are sought: where solves begin, how solutions are settled, which one is taken."""
