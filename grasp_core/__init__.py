"""Headless library: grasp trials in DART, simulated depth, datasets, networks, planners and their evaluation."""
