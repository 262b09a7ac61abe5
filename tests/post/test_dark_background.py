"""Figures on the dark background of a style."""

import matplotlib
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from rodsweep.post.figures.layout.dark_background import adapt_to_dark_background

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)


def curve_and_map():
    figure = Figure()
    left, right = figure.subplots(1, 2)
    left.plot([0, 1], [0, 1], "o-", color="k", mfc="white", label="curve")
    left.plot([0, 1], [1, 0], color="C0")
    left.scatter([0.5], [0.5], color="k")
    right.pcolormesh([[0, 1], [1, 0]])
    right.plot([0, 1], [0, 1], color="k", label="on the map")
    return figure, left, right


def test_black_lines_are_drawn_in_the_colour_of_texts_on_a_dark_background():
    with matplotlib.rc_context(matplotlib.style.library["dark_background"]):
        figure, left, right = curve_and_map()
        left.legend()
        right.legend()
        adapt_to_dark_background(figure)
    black, blue = left.lines
    assert to_rgb(black.get_color()) == to_rgb(black.get_markeredgecolor()) == WHITE
    assert to_rgb(black.get_markerfacecolor()) == BLACK
    assert blue.get_color() == "C0"
    assert tuple(left.collections[0].get_facecolor()[0][:3]) == WHITE
    assert to_rgb(right.lines[0].get_color()) == BLACK
    legend = right.get_legend()
    assert legend.get_frame_on() and min(legend.get_frame().get_facecolor()[:3]) > 0.8
    assert to_rgb(legend.get_texts()[0].get_color()) == BLACK


@pytest.mark.parametrize("style", ["default", "ggplot"])
def test_figures_with_a_light_background_are_not_changed(style):
    with matplotlib.rc_context(matplotlib.style.library.get(style, {})):
        figure, left, _ = curve_and_map()
        adapt_to_dark_background(figure)
    assert to_rgb(left.lines[0].get_color()) == BLACK
    assert to_rgb(left.lines[0].get_markerfacecolor()) == WHITE
