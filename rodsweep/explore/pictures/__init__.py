"""The pictures of the page, one module each: a Bokeh figure, and how an answer fills it."""
