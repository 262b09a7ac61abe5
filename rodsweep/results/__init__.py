"""The result file: its schema as one table, the store that survives kills, and provenance.

The only importer of h5py. Nothing here knows how a number was computed.
"""
