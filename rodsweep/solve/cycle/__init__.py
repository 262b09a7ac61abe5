"""The limit cycle of one rod: start of Newton's method, mesh refinement, error estimates, Floquet
multipliers."""
