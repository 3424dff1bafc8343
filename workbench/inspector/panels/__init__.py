"""The panels of the control column."""
