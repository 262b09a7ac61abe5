"""The characteristic determinant D(w) and all computations that need only D: no mesh and no PETSc.

Contents: D without cancellation, the a-priori box of eigenvalues, Newton's method, proved counts of
eigenvalues, the covering that finds all changes of stability along a path, and stability boundaries.
"""
