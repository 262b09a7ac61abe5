"""Portrait of a rod: thresholds, branches, modes and cycles of one rod in one picture and one paragraph.

`rodsweep.tasks.rod_portrait` solves for the results.
"""
