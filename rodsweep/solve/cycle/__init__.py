"""The limit cycle of one rod: start, Newton's method, refinement and measurement."""
