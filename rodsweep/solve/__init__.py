"""One parameter point at a time. The only importers of petsc4py and slepc4py are in this package.

No file, no message and no other point is known here, so a point's numbers depend on its parameters
alone: not on the rank, nor on what was solved before.
"""
