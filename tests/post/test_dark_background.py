"""Figures on the dark background of a style."""

import matplotlib
import pytest
from known_cycles import make_view
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from rodsweep.post.figures.cycle.amplitudes.amplitude import draw_amplitude
from rodsweep.post.figures.style import draw_shared_legend, text_colour

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)


@pytest.mark.parametrize("style", ["default", "ggplot", "dark_background"])
def test_black_lines_are_drawn_in_the_colour_of_texts(style):
    with matplotlib.rc_context(matplotlib.style.library.get(style, {})):
        assert to_rgb(text_colour()) == (WHITE if style == "dark_background" else BLACK)


@pytest.mark.parametrize("style", ["default", "dark_background"])
def test_open_markers_have_the_colour_of_their_panel(style):
    view = make_view(([20.0, 30.0, 40.0], [1e4], [1e2], [1e-2], [1.0]), [1, 0, 5])
    with matplotlib.rc_context(matplotlib.style.library.get(style, {})):
        panel = draw_amplitude([view])[0].axes[0]
        (marks,) = (line for line in panel.lines if line.get_label() == "unstable cycle")
        assert to_rgb(marks.get_mfc()) == to_rgb(panel.get_facecolor())


@pytest.mark.parametrize("has_map", [False, True])
def test_the_legend_of_a_map_is_light_on_a_dark_background(has_map):
    with matplotlib.rc_context(matplotlib.style.library["dark_background"]):
        figure = Figure()
        panel = figure.subplots()
        if has_map:
            panel.pcolormesh([[0, 1], [1, 0]])
        panel.plot([0, 1], [0, 1], color="k", label="a line")
        draw_shared_legend(figure, column_count=1)
    (legend,) = figure.legends
    assert legend.get_frame_on() == has_map
    assert to_rgb(legend.get_texts()[0].get_color()) == (BLACK if has_map else WHITE)
