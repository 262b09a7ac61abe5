"""`rodsweep explore`: a local web page for exploring a rod or an arm interactively.

Texts from the controls, or from the page's address, form a `PageState`. The page checks the state and sends
questions, such as "spectrum", to solver processes, which call `rodsweep.api`; their answers fill the
pictures. The page itself solves nothing. Only this package imports bokeh and tornado.
"""
