"""Image-based planners to compare the cascade with."""
