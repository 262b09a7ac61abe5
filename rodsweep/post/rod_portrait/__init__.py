"""Portrait of a rod: thresholds, branches, modes and cycles of one rod in one figure and one paragraph.

The results are computed by `rodsweep.tasks.rod_portrait`.
"""
