"""Benchmarks: speed against error of rodsweep, with all methods timed in turn in one run.

Other codes, the peers, are in a folder outside the package, from which `rodsweep.bench.peers` imports them.
"""
