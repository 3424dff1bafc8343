"""The panels of the inspector's two columns."""
