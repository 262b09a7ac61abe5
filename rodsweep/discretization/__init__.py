"""Spectral elements on [0, 1]: quadrature, basis, the constant matrix pieces, and how fine is enough.

Plain NumPy arrays; no PETSc and no MPI.
"""
