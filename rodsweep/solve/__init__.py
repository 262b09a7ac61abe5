"""Solvers for one parameter point at a time. Only this package imports petsc4py and slepc4py.

A solver knows no file, no MPI message and no other point: the result of a point depends on its parameters
alone, not on the MPI rank nor on earlier solves.
"""
