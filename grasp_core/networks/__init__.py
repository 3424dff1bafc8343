"""The two networks, their runtime and their weights."""
