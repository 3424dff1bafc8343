"""What runs in worker processes: short chains of calls that any script could make; no rule of the app's own."""
