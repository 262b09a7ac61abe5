"""Many points: from axes to points, who solves which, and the loop. The only sender of MPI messages.

Nothing here knows HDF5: finished points go to a function that the caller gives.
"""
