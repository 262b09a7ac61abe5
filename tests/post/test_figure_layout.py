"""Figures at the widths of a page: nothing cut, no text over another, every value within its axes."""

from dataclasses import replace
from functools import cache
from itertools import combinations
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from known_cycles import make_view
from matplotlib.figure import Figure
from matplotlib.text import Text
from surveyed import RODS, few

import rodsweep as rs
from rodsweep.api.dataset import view_of_dataset
from rodsweep.post.figures import draw
from rodsweep.post.figures.cycle.animation import prepared_animation
from rodsweep.post.figures.cycle.selection import chosen_cycles
from rodsweep.post.figures.layout.layout_fitting import WORD_PATTERN, break_lines, fit_layout
from rodsweep.post.figures.layout.tick_thinning import visible_labels
from rodsweep.post.figures.request import FigureLook
from rodsweep.post.figures.style import FIGURE_STYLE

COLUMN_WIDTHS = ("89 mm", "183 mm", None)
IN_TURN = ("89 mm", "183 mm", "89 mm", None)
"""The widths of one figure after another: most at that of a column, where there is the least room."""
LONG = "An arm of silicone whose length is to be chosen for the laboratory, a title too long for a line"
ROD = {"k1": 1e4, "k2": 1e2, "gamma3": 1e-2}
DIGITS = {"k1": 16234.567, "k2": 482.897384, "gamma3": 0.00398609931}
"""A rod as an arm makes it, whose numbers have all their digits."""
LEAST_HEIGHT = 0.3
"""Inches of a panel below which nothing is read off it."""
MOST_BLANK = 0.7
"""Inches between a heading and the panels: twice the height of a heading of three lines."""
TOUCH = 0.01
"""Inches by which the boxes of two texts may lie over each other: they have blank edges."""


def at_widths(figures, widths=COLUMN_WIDTHS, every=1):
    """Some of the figures, as tuples, each at one width in turn, and `make survey` tries each at all."""
    if RODS:
        return [(*figure, width) for figure in figures for width in widths]
    figures = figures[::every]
    turns = [width for width in IN_TURN if width in widths]
    return [(*figure, turns[number % len(turns)]) for number, figure in enumerate(figures)]


def drawn(view, tmp_path, monkeypatch, width, **words):
    """The figure as it is written, with what is wrong with it: the number of ticks depends on the style."""
    figures = []

    def take(figure, *_, **__):
        figure.draw_without_rendering()
        figure.faults = faults(figure)
        figures.append(figure)

    monkeypatch.setattr(Figure, "savefig", take)
    draw(view, tmp_path / "f.png", look=FigureLook(title=True, width=width), **words)
    return figures[0]


def texts_of(figure):
    """Every text that is seen, with its box in pixels; that of two panels at one place is there once."""
    found = list(figure.texts)
    for legend in figure.legends:
        found += legend.get_texts()
    for axes in [*figure.axes, *(child for panel in figure.axes for child in panel.child_axes)]:
        if axes.get_visible() and axes.axison:
            found += [text for text in axes.get_children() if isinstance(text, Text)]
            found += axes.get_legend().get_texts() if axes.get_legend() else []
            for axis in (axes.xaxis, axes.yaxis):
                found += [axis.label, axis.get_offset_text(), *visible_labels(axis)]
    seen = [text for text in found if text.get_visible() and text.get_text().strip()]
    boxes = {(text.get_text(), tuple(text.get_window_extent().extents.round())): text for text in seen}
    return [(name, text.get_window_extent()) for (name, _), text in boxes.items()]


def faults(figure):
    """What is wrong with the layout of a figure, in words."""
    texts, page, touch = texts_of(figure), figure.bbox, TOUCH * figure.dpi
    boxes = [*texts, *(("the legend", legend.get_window_extent()) for legend in figure.legends)]
    wrong = [
        f"{name!r} is cut"
        for name, box in boxes
        if min(box.x0, box.y0, page.x1 - box.x1, page.y1 - box.y1) < -touch
    ]
    for legend in figure.legends:
        box = legend.get_window_extent()
        wrong += ["the legend is over a panel"] * any(box.overlaps(axes.bbox) for axes in figure.axes)
    for (name, one), (other, two) in combinations(texts, 2):
        across = min(one.x1, two.x1) - max(one.x0, two.x0)
        down = min(one.y1, two.y1) - max(one.y0, two.y0)
        if min(across, down) > touch:
            wrong.append(f"{name!r} and {other!r} are over each other")
    flat = [axes for axes in figure.axes if axes.bbox.height < LEAST_HEIGHT * figure.dpi]
    wrong += ["a panel is too flat" for axes in flat if not (is_bar(axes) or axes.get_aspect() != "auto")]
    return wrong + [f"{count} values lie beyond {axes.get_ylabel()!r}" for axes, count in beyond(figure)]


def is_bar(axes):
    """Whether a panel holds colours alone, along which nothing is read but its ends."""
    return axes.get_subplotspec() is None or not axes.get_yticks().size or hasattr(axes, "_colorbar")


def beyond(figure):
    """(axes, number of values that are drawn outside of them) of a figure."""
    for axes in figure.axes:
        limits = [sorted(axes.get_xlim()), sorted(axes.get_ylim())]
        lines = [line for line in axes.lines if line.get_transform() == axes.transData]
        dots = [some for some in axes.collections if some.get_offset_transform() == axes.transData]
        places = [np.column_stack([np.asarray(a, float) for a in line.get_data()]) for line in lines]
        outside = 0
        for given in [*places, *(np.asarray(some.get_offsets(), float) for some in dots)]:
            known = given[np.isfinite(given).all(axis=1)]
            for column, (low, high) in zip(known.T, limits, strict=True):
                slack = 1e-9 * max(abs(low), abs(high))
                outside += np.count_nonzero((column < low - slack) | (column > high + slack))
        if outside:
            yield axes, outside


@cache
def solved(name):
    """Results of every task that solves, coarse."""
    task, words = SOLVED[name]
    data = rs.sweep(task, title=LONG, **words)
    return view_of_dataset(data, Path(f"{name}.h5"))


DIAGRAM = {"F": rs.linspace(0, 250, 11), "k1": rs.logspace(30, 1000, 7)}
SOFT = {"k1": rs.logspace(100, 400, 4)}
SOLVED = {
    "line": ("spectrum", {"F": rs.linspace(0, 60, 31), **DIGITS, "modes": 4}),
    "one_mode": ("spectrum", {"F": rs.linspace(0, 60, 7), **ROD, "modes": 1}),
    "point": ("spectrum", {"F": 50, **DIGITS, "modes": 6}),
    "map": ("spectrum", {"F": rs.linspace(0, 60, 13), **ROD, "k2": rs.logspace(10, 1e4, 7)}),
    "rod": ("thresholds", {"k1": 200, "k2": 1e4, "gamma3": 1e-4}),
    "readme": ("thresholds", {"k1": [200, 1e4, np.inf], "k2": rs.logspace(10, 1e6, 17), "gamma3": 1e-4}),
    "forces": ("thresholds", {"k1": 1e4, "k2": rs.logspace(5, 1e6, 9), "gamma3": rs.logspace(1e-6, 10, 8)}),
    "diagram": ("phase_diagram", {**DIAGRAM, "k2": 1e4, "gamma3": 1e-4, "curves": True}),
    "modes": ("modes", {"F": [10, 20], **DIGITS, "nodes": 9, "growth": False}),
    "branch": ("branch", {"k1": [150, 200], "k2": 1e4, "gamma3": 1e-4, "stop": 100, "accuracy": 1e-4}),
    "criticality": ("criticality", {**SOFT, "k2": 1e4, "gamma3": [1e-4, 1e-2], "F_max": 100}),
}  # fmt: skip
CASES = {
    "line": ({}, {"roots": "all"}, {"roots": "rightmost"}),
    "one_mode": ({},),
    "point": ({},),
    "map": ({},),
    "rod": ({},),
    "readme": ({}, {"what": "map"}),
    "forces": ({}, {"what": "lines"}),
    "diagram": ({},),
    "modes": ({},),
    "branch": ({},),
    "criticality": ({},),
}


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "words", "width"),
    at_widths([(name, words) for name in CASES for words in CASES[name][: None if RODS else 1]], every=2),
)
def test_nothing_is_cut_or_over_anything_else(name, words, width, tmp_path, monkeypatch):
    assert drawn(solved(name), tmp_path, monkeypatch, width, **words).faults == []


def of_cycles(forces, gamma1, seed, **words):
    """Cycles known in closed form of a rod whose numbers have all their digits, under a long title."""
    rng = np.random.default_rng(seed)
    axes = (forces, [DIGITS["k1"]], [DIGITS["k2"]], [DIGITS["gamma3"]], gamma1)
    count = len(forces) * len(gamma1)
    status = np.where(rng.random(count) < words.pop("others", 0.0), rng.integers(-1, 6, count), 0)
    view = make_view(axes, status, **words)
    return replace(view, attributes=view.attributes | {"title": LONG})


CYCLES = {
    "one": (([50.0], [0.728427380530]), ("cycle", "energy")),
    "two": (([50.0], [0.728427380530, 1.0]), ("cycle", "energy")),
    "three": (([50.0, 123.456789, 200.0], [1.0]), ("cycle", "energy", "amplitude")),
    "few lines": ((list(np.linspace(20, 120, 9)), [0.5, 0.75, 1.0]), ("amplitude", "maps")),
    "six lines": ((list(np.linspace(20, 120, 9)), list(np.linspace(0.5, 1.0, 6))), ("amplitude", "maps")),
    "many lines": ((list(np.linspace(20, 120, 9)), list(np.geomspace(0.1, 10.0, 20))), ("maps",)),
    "a row": (([20.0, 60.0], list(np.geomspace(0.5, 1.0, 8))), ("maps",)),
}


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "what", "width"),
    at_widths(
        [(name, what) for name, (_, kinds) in CYCLES.items() for what in kinds], COLUMN_WIDTHS[:2], every=4
    ),
)
def test_nothing_of_cycles_is_cut_or_over_anything_else(name, what, width, tmp_path, monkeypatch):
    (axes, _), some = CYCLES[name], 0.0 if what in ("cycle", "energy") else 0.3
    view = of_cycles(*axes, seed=1, others=some)
    assert drawn(view, tmp_path, monkeypatch, width, what=what).faults == []


def known_to(error, forces=(50.0, 123.456789, 200.0)):
    """Cycles whose periods, amplitudes and powers have all digits, and whose relative error this is."""
    view = make_view((list(forces), [np.inf], [np.inf], [0.0], [0.5]), [0] * len(forces))
    v = view.variables
    scale = {"period": 1.0123456789, "injection_mean": 1.0123456789}
    given = dict.fromkeys(("period_error", "amplitude_error"), np.full(v["period"].shape, error))
    return replace(view, variables=v | given | {name: v[name] * by for name, by in scale.items()})


@pytest.mark.long
@pytest.mark.parametrize(("what", "width"), at_widths([("cycle",), ("energy",)]))
def test_a_period_with_all_its_digits_is_not_cut(what, width, tmp_path, monkeypatch):
    assert drawn(known_to(1e-9), tmp_path, monkeypatch, width, what=what).faults == []


@pytest.mark.parametrize(
    ("error", "period"), few([(1e-4, "0.02632"), (1e-9, "0.026321"), (1e-2, "0.026")], 1)
)
def test_a_period_has_the_digits_that_its_error_leaves(error, period, tmp_path, monkeypatch):
    figure = drawn(known_to(error, [50.0]), tmp_path, monkeypatch, None, what="energy")
    words = figure.axes[0].get_title()
    assert rf"$T\,{{=}}$ ${period}\,\tau_2$" in words
    assert ("mean power $2024.69$" in words) == (error < 1e-6)


@pytest.mark.parametrize("forces", few([[0.5, 0.6, 0.7], [0.5], [50.0]], 1))
def test_no_blank_is_left_above_flat_shapes(forces, tmp_path, monkeypatch):
    view = make_view((forces, [np.inf], [np.inf], [0.0], [1.0]), [0] * len(forces))
    figure = drawn(view, tmp_path, monkeypatch, "89 mm", what="cycle")
    heading = figure.texts[0].get_window_extent().y0
    highest = max(axes.title.get_window_extent().y1 for axes in figure.axes)
    assert heading - highest < MOST_BLANK * figure.dpi


@pytest.mark.parametrize("name", few(["two", "one", "three"], 1))
def test_the_frames_of_a_film_are_whole(name):
    selection = chosen_cycles(of_cycles(*CYCLES[name][0], seed=1), (), ())
    with matplotlib.rc_context(FIGURE_STYLE):
        figure, arms = prepared_animation(selection)
        for arm in arms:
            arm.show_frame(7)
        figure.draw_without_rendering()
        assert faults(figure) == []


@pytest.mark.long
@pytest.mark.parametrize(
    ("seed", "width"), at_widths([(seed,) for seed in range(4)], COLUMN_WIDTHS[:2], every=3)
)
def test_random_figures_of_cycles_are_whole(seed, width, tmp_path, monkeypatch):
    rng = np.random.default_rng(seed)
    forces = list(np.sort(rng.uniform(10, 10 ** rng.uniform(2, 4), rng.integers(2, 30))))
    gamma1 = list(np.sort(rng.uniform(0.3, 2, rng.integers(1, 7))))
    what = ["amplitude", "maps", "cycle", "energy"][seed % 4] if len(gamma1) > 1 else "amplitude"
    view = of_cycles(forces, gamma1, seed, others=0.0 if what in ("cycle", "energy") else 0.4)
    assert drawn(view, tmp_path, monkeypatch, width, what=what).faults == []


@pytest.mark.long
def test_every_threshold_of_the_first_config_of_the_readme_is_within_its_axes(tmp_path, monkeypatch):
    view = solved("readme")
    stored = sum(
        np.isfinite(view.variables[f"F_{name}"]).sum() for name in ("onset", "hopf", "restabilization")
    )
    figure = drawn(view, tmp_path, monkeypatch, "89 mm")
    axes = figure.axes[0]
    heights = np.concatenate([line.get_ydata() for line in axes.lines])
    low, high = axes.get_ylim()
    assert np.count_nonzero((heights >= low) & (heights <= high)) == stored


def test_words_of_mathematics_are_not_broken():
    assert WORD_PATTERN.findall(r"$\tilde k_1 = 200$, cost in \$ and $a$ b") == [
        r"$\tilde k_1 = 200$,", "cost", "in", r"\$", "and", "$a$", "b",
    ]  # fmt: skip


def test_no_break_spaces_hold_a_number_and_its_unit_together():
    assert WORD_PATTERN.findall("viscosity\xa030\xa0Pa\xa0s, a b") == [
        "viscosity\xa030\xa0Pa\xa0s,",
        "a",
        "b",
    ]


def test_lines_are_broken_only_where_they_are_too_long():
    figure = Figure(figsize=(4, 2))
    text = figure.text(0, 0.5, "one two three four\nfive")
    assert not break_lines(text, 1000)
    assert text.get_text() == "one two three four\nfive"
    assert break_lines(text, 60)
    assert text.get_text().split() == ["one", "two", "three", "four", "five"]
    assert text.get_window_extent().width <= 60


def test_a_figure_whose_text_leaves_no_room_for_its_panel_grows():
    figure = Figure(figsize=(3, 1), layout="constrained")
    axes = figure.subplots()
    figure.suptitle("\n".join(["a line"] * 8))
    fit_layout(figure, 0.5)
    figure.draw_without_rendering()
    assert axes.bbox.height >= 0.45 * axes.bbox.width
    assert figure.get_size_inches()[0] == 3
