"""Result files: one table as their schema, a store that survives kills, and provenance.

This package is the only importer of h5py. It does not know how a number was computed.
"""
