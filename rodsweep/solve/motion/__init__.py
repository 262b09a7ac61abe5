"""Time integration of the nonlinear rod by PETSc's TS, and initial states: leading mode, or rod bent until
its tip is at a given point."""
