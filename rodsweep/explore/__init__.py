"""`rodsweep explore`: a local web page for exploring a rod or an arm interactively.

Values travel as text from the controls, or from the page's address, into a `PageState`. The page checks the
state and sends questions, such as "spectrum", to solver processes, whose answers fill the pictures. The page
itself solves nothing: solver processes call `rodsweep.api`. Only this package imports bokeh and tornado.
"""
