"""Black lines and white markers of a figure, exchanged if a style draws on a dark background."""

from matplotlib import rcParams
from matplotlib.collections import Collection, QuadMesh
from matplotlib.colors import to_rgba, to_rgba_array
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.typing import ColorType

DARK_BELOW = 0.3
"""A colour is dark if red, green and blue are all below this number, from 0 to 1."""
WHITE_ABOVE = 0.95
"""A colour is white if red, green and blue are all above this number."""
LEGEND_BACKGROUND = "0.9"
"""Background of the legend of a map, whose black lines stay black, on a dark figure."""


def adapt_to_dark_background(figure: Figure) -> None:
    """Draws black lines in the colour of texts, and white markers in the colour of the background, if the
    background of the figure is dark. Lines on maps stay black: the colours of maps are light."""
    if not _is_dark(figure.get_facecolor()):
        return
    maps = [a for a in figure.axes if a.images or any(isinstance(c, QuadMesh) for c in a.collections)]
    for axes in figure.axes:
        if axes not in maps:
            for artist in [*axes.lines, *axes.collections]:
                _exchange_colours(artist, axes.get_facecolor())
    for legend in [*figure.legends, *(axes.get_legend() for axes in figure.axes)]:
        if legend is None:
            continue
        if maps:
            legend.set_frame_on(True)
            legend.get_frame().set_facecolor(LEGEND_BACKGROUND)
            for text in legend.get_texts():
                text.set_color("black")
        else:
            for handle in legend.legend_handles:
                _exchange_colours(handle, figure.get_facecolor())


def _exchange_colours(artist: object, background: ColorType) -> None:
    """Exchanges black and white of a line with its markers, or of a collection of lines or markers."""
    if isinstance(artist, Line2D):
        # All are read before one is set: the colours of markers may follow the colour of the line.
        colours = artist.get_color(), artist.get_markeredgecolor(), artist.get_markerfacecolor()
        line, edge_, face_ = (_exchanged_colour(colour, background) for colour in colours)
        artist.set(color=line, markeredgecolor=edge_, markerfacecolor=face_)
    elif isinstance(artist, Collection):
        artist.set_edgecolor(
            [_exchanged_colour(colour, background) for colour in to_rgba_array(artist.get_edgecolor())]
        )
        artist.set_facecolor(
            [_exchanged_colour(colour, background) for colour in to_rgba_array(artist.get_facecolor())]
        )


def _exchanged_colour(colour: ColorType, background: ColorType) -> ColorType:
    """The colour of texts for a dark colour, `background` for white, and otherwise `colour`."""
    *rgb, alpha = to_rgba(colour)
    if alpha == 0:
        return colour
    if _is_dark(colour):
        return to_rgba(rcParams["text.color"])
    return background if min(rgb) > WHITE_ABOVE else colour


def _is_dark(colour: ColorType) -> bool:
    return max(to_rgba(colour)[:3]) < DARK_BELOW
