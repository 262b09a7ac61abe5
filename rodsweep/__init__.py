"""rodsweep: when a follower-loaded soft rod in a viscous fluid oscillates and flutters.

Importing the package starts neither MPI nor PETSc.
"""

__version__ = "0.1.0"
