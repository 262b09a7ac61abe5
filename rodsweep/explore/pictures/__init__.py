"""Pictures of the page, one module each: a Bokeh figure, and a method that fills it from an answer."""
