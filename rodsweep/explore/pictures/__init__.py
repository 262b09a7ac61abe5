"""The pictures of the page, each in a module: a Bokeh figure, and the way from an answer to the figure's
data."""
