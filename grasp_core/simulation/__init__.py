"""Grasp trials in DART."""
