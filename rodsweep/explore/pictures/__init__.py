"""Pictures of the page. Each class holds a Bokeh figure, and methods that fill the figure from an answer."""
