"""D(w), and everything that needs D alone: no mesh and no PETSc.

Its value without cancellation, the a-priori box, Newton's method, proved counts, the covering that finds
all points of a path where the spectrum changes, and the curves of such points in a plane.
"""
