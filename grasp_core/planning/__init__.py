"""Planners: depth image in, plan out."""
