"""Result files: the table of their variables, storage that survives a kill of the run, and provenance.

Only this package imports h5py. The package does not use the solvers.
"""

RESULT_SUFFIXES = (".h5", ".hdf5", ".nc")
"""Allowed endings of the names of result files."""
