"""`rodsweep explore`: a local page for exploring a rod or an arm interactively.

Values travel as text from the controls, or the address, into a `PageState`. The page checks the state and
sends questions to solver processes, whose answers fill the pictures. The page solves nothing itself and uses
solvers through `rodsweep.api` alone. Only this package imports bokeh and tornado.
"""
