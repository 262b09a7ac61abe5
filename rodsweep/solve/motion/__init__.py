"""Time integration of the nonlinear rod by PETSc's TS, from an initial state."""
