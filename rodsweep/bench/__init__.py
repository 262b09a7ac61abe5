"""Benchmarks: computing time and error of rodsweep and of other methods, timed in turn in one run.

Methods of other codes, the peers, are in a folder outside the package, from which `rodsweep.bench.peers`
imports them.
"""
