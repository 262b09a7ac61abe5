"""PETSc, SLEPc and the BLAS, without knowledge of the rod."""
