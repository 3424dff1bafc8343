"""The browser workbench; it holds no algorithm, all of those are in grasp_core."""
