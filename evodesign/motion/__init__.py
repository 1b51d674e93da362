"""Lifts as motions: agents who move with their load in time, with inertia and speed."""
