"""Replay of a design's postures for robotics viewers: an MCAP file of Foxglove's schemas, and a layout."""
