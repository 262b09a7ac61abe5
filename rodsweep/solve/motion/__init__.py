"""Time integration of the nonlinear rod by PETSc TS."""
