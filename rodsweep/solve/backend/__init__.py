"""Interfaces to PETSc, SLEPc, BLAS and LAPACK, without knowledge of the rod."""
