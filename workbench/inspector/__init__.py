"""The inspector: what the planner sees and thinks, and what physics says of it."""
