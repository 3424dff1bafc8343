"""Measured comparison of planners."""
