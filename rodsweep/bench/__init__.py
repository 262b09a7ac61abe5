"""Speed against error of rodsweep itself, all methods timed in turn in one run.

What rodsweep is timed beside is not here: `rodsweep.bench.peers` takes it from a folder outside the package.
"""
