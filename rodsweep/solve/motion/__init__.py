"""The nonlinear rod in time, by PETSc TS."""
