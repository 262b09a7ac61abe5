"""`rodsweep explore`: a local page on which a rod or an arm is explored live.

Values travel as text from the controls (or the address) into a `PageState`; the page checks it and asks
solvers, each a process of its own; their answers fill the pictures. The page solves nothing itself, and knows
no solver but through `rodsweep.api`. Only this package imports bokeh and tornado.
"""
