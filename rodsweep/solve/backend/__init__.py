"""PETSc, SLEPc and the BLAS themselves; nothing here knows the rod."""
