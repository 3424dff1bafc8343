"""Simulated depth and what happens to an image before planning."""
