"""Solvers for one parameter point at a time. Only this package imports petsc4py and slepc4py.

A solver uses no file, no MPI message and no result of another point, unless the caller passes one: the result
of a point depends on its parameters alone, not on the MPI rank nor on earlier solves.
"""
