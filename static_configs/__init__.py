"""Shipped configuration files; found through importlib.resources (see `grasp_core.config`)."""
