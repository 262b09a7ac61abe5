"""The determinant D(w) and all computations that need D alone: no mesh and no PETSc.

Value of D without cancellation, the a-priori box of eigenvalues, Newton's method, proved counts of
eigenvalues, the covering that finds all changes of the spectrum along a path, and curves of changes in a
plane.
"""
