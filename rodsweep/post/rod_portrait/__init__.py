"""Portrait of a rod: everything about one rod in one picture and one paragraph.

`rodsweep.tasks.rod_portrait` solves what is drawn here.
"""
