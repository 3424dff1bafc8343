"""What is drawn in the scene and the images."""
