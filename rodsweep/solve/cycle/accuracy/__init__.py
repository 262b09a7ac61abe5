"""A cycle to an accuracy that is asked for: its mesh, its errors, and whether its period is minimal."""
