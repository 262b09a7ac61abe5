"""Result files: the table of their variables, a store that survives kills, and provenance.

This package is the only importer of h5py. Solvers are unknown here.
"""
