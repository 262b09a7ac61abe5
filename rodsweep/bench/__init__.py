"""Speed against error of rodsweep itself; all methods are timed in turn in one run.

The peers of rodsweep are in a folder outside the package, from which `rodsweep.bench.peers` imports them.
"""
