"""Portrait of a rod: all results for one rod in one picture and one paragraph.

`rodsweep.tasks.rod_portrait` solves for the results.
"""
