"""Interfaces to PETSc, SLEPc, BLAS and LAPACK, and pools of solvers, without knowledge of the rod."""
