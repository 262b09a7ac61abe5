"""Maps of period and amplitude over two parameters: colours, statuses, the line of F**, what is refused."""

from pathlib import Path

import numpy as np
import pytest
from known_cycles import TORUS, UNSTABLE, hopf_variables, make_view, store
from matplotlib.collections import PolyCollection, QuadMesh
from matplotlib.colors import LogNorm
from surveyed import few

from rodsweep.errors import InputError
from rodsweep.post.figures import draw
from rodsweep.post.figures.cells import cell_edges, point_grid
from rodsweep.post.figures.cycle.maps import STATUS_LOOKS, draw_maps, hopf_lines
from rodsweep.post.figures.limit_cycle import chosen_figure_kind
from rodsweep.post.figures.request import FigureRequest

pytestmark = pytest.mark.filterwarnings("error::UserWarning")

WORDS = {"stored": ()}


def rising(F, k1, k2, gamma3, gamma1):
    return 20 + 6 * np.log10(k2)


def swept(F, k2, *, status=None, **words):
    """A sweep over F and k2 whose rods beat above F**, but where a status is given by (place in F, in k2)."""
    axes = (list(F), [1e4], list(k2), [1e-2], [1.0])
    table = np.meshgrid(*axes, indexing="ij")
    numbers = np.where(table[0] > rising(*table), 0, 1)
    for (i, j), number in (status or {}).items():
        numbers[i, 0, j] = number
    return make_view(axes, numbers, hopf=rising, **(WORDS | words))


SMALL = ([20.0, 30, 60], [1.0, 2, 3, 5, 8, 20, 50, 100])


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def meshes(figure):
    """The coloured cells of period and amplitude: the panels come before their colour bars."""
    return [next(c for c in axes.collections if isinstance(c, QuadMesh)) for axes in figure.axes[:2]]


def holds(collection, place):
    """Whether a place in data coordinates lies in one of the polygons."""
    return any(path.contains_point(place) for path in collection.get_paths())


def as_list(view, seed):
    """The points of a grid as a list, in an order of its own."""
    order = np.random.default_rng(seed).permutation(view.variables["status"].size)
    columns = [view.point_columns[name][order] for name in view.parameters]
    return make_view(columns, view.variables["status"].ravel()[order], as_list=True, hopf=rising, **WORDS)


@pytest.mark.parametrize("listed", [False, True])
def test_every_cell_has_the_value_of_its_point(listed):
    view = swept((60.0, 20, 30), (8.0, 1, 100, 3, 50, 20, 2), status={(0, 0): 2})
    grid = view
    if listed:
        view = as_list(view, 7)
    period, amplitude = meshes(draw_maps(view)[0])
    k2, F = np.meshgrid(np.sort(grid.variables["k2"]), [20, 30, 60], indexing="ij")
    place = F - rising(F, 0, k2, 0, 0)
    beats = (place > 0) & ~((F == 60) & (k2 == 8))
    values = np.ma.asarray(amplitude.get_array()).reshape(k2.shape)
    assert (~np.ma.getmaskarray(values) == beats).all()
    assert values[beats].tolist() == pytest.approx(np.sqrt(place[beats] / (F - place)[beats]) / 2)
    assert (np.ma.getmaskarray(period.get_array()).reshape(k2.shape) == ~beats).all()
    corners = np.asarray(amplitude.get_coordinates())
    assert corners[0, :, 0] == pytest.approx(cell_edges(np.array([20.0, 30, 60])))
    assert corners[:, 0, 1] == pytest.approx(cell_edges(np.unique(k2)))


@pytest.mark.parametrize(
    ("values", "edges"),
    [
        ([1, 2, 4, 7], [0.5, 1.5, 3, 5.5, 8.5]),
        ([1, 10, 100], [10**-0.5, 10**0.5, 10**1.5, 10**2.5]),
        ([1, 2, 20], [2**-0.5, 2**0.5, 40**0.5, 20 * 10**0.5]),
        ([-1, 0, 1], [-1.5, -0.5, 0.5, 1.5]),
    ],
)
def test_cells_end_half_way_in_the_scale_of_the_axis(values, edges):
    assert cell_edges(np.array(values, float)) == pytest.approx(edges)


@pytest.mark.parametrize(("ratio", "logarithmic"), [(9.0, False), (11.0, True)])
def test_colours_of_the_period_are_logarithmic_over_more_than_a_decade(ratio, logarithmic):
    view = swept(*SMALL)
    view.variables["period"][-1] *= np.linspace(1, ratio, 8)[None, :, None, None]
    view.variables["tip_y_max"][-1, 0, -1] = 1e-3
    period, amplitude = meshes(draw_maps(view)[0])
    assert isinstance(period.norm, LogNorm) == logarithmic
    assert not isinstance(amplitude.norm, LogNorm)


STATUSES = {(2, 0): 2, (2, 1): 3, (2, 3): 4, (2, 4): -1, (2, 5): TORUS, (1, 0): UNSTABLE, (2, 6): UNSTABLE}


def test_every_status_without_a_cycle_fills_its_cells_and_has_its_place_in_the_legend():
    figure = draw_maps(swept(*SMALL, status=STATUSES))[0]
    words = ["straight", "missing", "not settled", "left the model", "failed", "torus"]
    assert legend(figure) == [*words, r"Hopf points $\tilde F_{**}$", "unstable cycle"]
    looks = {(patch.get_facecolor(), patch.get_hatch()) for patch in figure.legends[0].get_patches()}
    assert len(looks) == len(words)
    hatches = {word.replace("_", " "): look[1] for word, look in STATUS_LOOKS.items()}
    hatches["torus"] = "++++"
    own = dict(zip((-1, 2, 3, 4, TORUS, UNSTABLE), (*words[1:], None), strict=True))
    for axes in figure.axes[:2]:
        filled = [c for c in axes.collections if isinstance(c, PolyCollection) and len(c.get_paths())]
        for i, F in enumerate(SMALL[0]):
            for j, k2 in enumerate(SMALL[1]):
                straight = "straight" if rising(F, 0, k2, 0, 0) >= F else None
                word = own.get(STATUSES.get((i, j)), straight)
                here = [c.get_hatch() or "" for c in filled if holds(c, (F, k2))]
                assert here == ([] if word is None else [hatches[word]]), (F, k2)


def test_unstable_cycles_keep_their_colour_under_an_open_marker():
    figure = draw_maps(swept(*SMALL, status=STATUSES))[0]
    for axes, mesh in zip(figure.axes[:2], meshes(figure), strict=True):
        (marks,) = (line for line in axes.lines if line.get_mfc() == "white")
        assert set(zip(*marks.get_data(), strict=True)) == {(30, 1), (60, 50)}
        values = np.ma.asarray(mesh.get_array()).reshape(8, 3)
        assert values[0, 1] > 0
        assert values[6, 2] > 0


@pytest.mark.parametrize("shape", [(3, 8), (8, 3), (100, 100), (9, 15)])
def test_the_line_of_hopf_points_is_where_the_rod_starts_to_beat(shape):
    """F** rises by 6 a decade of k2: a straight line in the scale of the axes."""
    view = swept(np.linspace(20, 60, shape[0]), np.geomspace(2, 1000, shape[1]))
    (line,) = hopf_lines(point_grid(view), view)
    forces, k2 = line
    off = np.abs(forces - rising(forces, 0, k2, 0, 0)) * (shape[0] - 1) / 40  # in steps of F
    on_row = np.isclose(k2[:, None], view.variables["k2"]).any(axis=1)
    assert on_row.sum() >= shape[1]
    assert off[on_row].max() < 1e-9
    assert off.max() < 0.06
    assert (k2.min(), k2.max()) == (pytest.approx(2), pytest.approx(1000))


def test_a_line_of_hopf_points_that_turns_back_is_one_line():
    """A window of flutter that closes as k2 falls, as that of the extensible rod does as k1 falls."""
    view = swept(np.linspace(30, 170, 15), np.linspace(100, 200, 11))
    F, k2 = (view.variables[name] for name in ("F", "k2"))
    window = (k2 - 122) / 80 - ((F[:, None] - 101) / 60) ** 2
    view.variables["linear_growth_rate"] = 1e2 * window[:, None, :, None, None]
    half = 60 * np.sqrt((k2[k2 > 122] - 122) / 80)
    ends = [
        (101 + side * width, 1e4, k, 1e-2)
        for k, width in zip(k2[k2 > 122], half, strict=True)
        for side in (-1, 1)
    ]
    kinds = ["hopf", "restabilization"] * len(half)
    view.variables.update(hopf_variables("F", ends, kinds=kinds))
    (line,) = hopf_lines(point_grid(view), view)
    at_end = line[:, line[1] == 200]
    assert np.sort(at_end[0]) == pytest.approx(101 + 60 * np.sqrt(78 / 80) * np.array([-1, 1]), abs=0.1)
    assert 120 < line[1].min() < 130


def test_no_line_crosses_points_that_are_missing():
    view = swept(np.linspace(20, 60, 41), np.geomspace(1, 1000, 31))
    view.variables["linear_growth_rate"][:, :, 10:13] = np.nan
    lines = hopf_lines(point_grid(view), view)
    k2 = view.variables["k2"]
    assert len(lines) == 2
    assert not any(((line[1] > k2[9] * 1.001) & (line[1] < k2[13] * 0.999)).any() for line in lines)


def test_no_hopf_point_is_drawn_where_every_rod_beats():
    view = swept(np.linspace(50, 60, 7), np.geomspace(1, 1000, 8))
    assert hopf_lines(point_grid(view), view) == []
    assert draw_maps(view)[0].legends == []


FORCES = list(np.linspace(20, 60, 5))


def make_list():
    return as_list(swept(FORCES, np.geomspace(1, 100, 7)), 3)


@pytest.mark.parametrize(
    ("axes", "points", "output", "what"),
    [
        ((FORCES, [1e4], [1e2], [1e-2], np.linspace(1, 2, 7)), (), "f.png", "maps"),
        ((FORCES, [1e4], [1e2], [1e-2], np.linspace(1, 2, 6)), (), "f.png", "amplitude"),
        ((FORCES, [1e4, 1e5], [1e2], [1e-2], np.linspace(1, 2, 7)), (), "f.png", "amplitude"),
        (([50.0], [1e4], np.linspace(50, 99, 8), np.linspace(1, 2, 7), [1.0]), (), "f.png", "maps"),
        (([50.0], [1e4], np.linspace(50, 99, 8), [1e-2], [1.0]), (), "f.png", "amplitude"),
        ((FORCES, [1e4], [1e2], [1e-2], np.linspace(1, 2, 7)), (3,), "f.png", "cycle"),
        ((FORCES, [1e4], [1e2], [1e-2], np.linspace(1, 2, 7)), (), "f.gif", "animation"),
    ],
)
def test_maps_are_suggested_where_amplitudes_have_no_room(axes, points, output, what):
    view = make_view(axes, np.zeros(np.prod([len(values) for values in axes])), **WORDS)
    assert chosen_figure_kind(FigureRequest([view], Path(output), points=points)) == what


def test_a_list_that_forms_a_grid_is_drawn_as_maps():
    assert chosen_figure_kind(FigureRequest([make_list()], Path("f.png"))) == "maps"


@pytest.mark.long
@pytest.mark.parametrize("suffix", few(["pdf", "png"], 1))
def test_a_hundred_by_a_hundred_points_are_drawn_with_some_missing(tmp_path, suffix):
    numbers = np.random.default_rng(2).choice(10_000, 300, replace=False)
    status = {divmod(int(n), 100): -1 if n % 2 else 4 for n in numbers}
    view = swept(np.linspace(20, 60, 100), np.geomspace(10, 1000, 100), status=status)
    output = tmp_path / f"f.{suffix}"
    lacking = f"of 10000 points {sum(n % 2 for n in numbers)} are not computed"
    assert draw(view, output).startswith(f"wrote {output}: period and amplitude over F and k2; {lacking}")
    assert 2e4 < output.stat().st_size < 5e6


def test_an_infinite_value_is_left_out_and_the_message_says_so(tmp_path):
    view = swept(SMALL[0], [*SMALL[1], np.inf])
    message = draw(view, tmp_path / "f.png")
    assert "k2 = inf has no place on an axis and is left out" in message
    assert point_grid(view).y.tolist() == SMALL[1]


def scattered():
    view = make_list()
    view.variables["k2"][3] *= 1.1
    return view


def twice():
    view = make_list()
    columns = [np.append(view.variables[name], view.variables[name][0]) for name in view.parameters]
    return make_view(columns, [0] * 36, as_list=True, **WORDS)


THREE = (FORCES, [1e4, 1e5], [1e2], [1e-2], [1.0, 0.5])


@pytest.mark.parametrize(
    ("views", "words", "message"),
    [
        (
            make_view(THREE, [0] * 20, **WORDS),
            {},
            "over two parameters, and F, k1, gamma1 vary; --at gamma1=VALUE selects the points",
        ),
        (
            make_view((FORCES, *THREE[2:3] * 4), [0] * 5, **WORDS),
            {},
            "and only F varies; without --what maps",
        ),
        (make_view(([50.0], *THREE[2:3] * 4), [0], **WORDS), {}, "and no parameter varies"),
        (scattered(), {}, "no grid over F and k2"),
        (twice(), {}, "no grid over F and k2"),
        (swept([1.0, 2], [10.0, 20]), {}, "no cycle that could be drawn"),
        (swept(FORCES, [10, np.inf]), {}, "fewer than two finite values of F or k2"),
        ([swept(*SMALL), swept(*SMALL)], {}, "only amplitudes of several files"),
        (swept(*SMALL), {"points": (1,)}, "--point is given, but maps show all points"),
    ],
)
def test_what_no_map_can_show_is_refused_in_one_sentence(tmp_path, views, words, message):
    with pytest.raises(InputError, match=message) as refused:
        draw(views, tmp_path / "f.png", what="maps", **words)
    assert len(str(refused.value).splitlines()) == 1
    assert not (tmp_path / "f.png").exists()


@pytest.mark.long
def test_a_file_as_the_task_lays_it_out_is_mapped(command):
    view = swept(*SMALL, stored=("shapes", "samples"))
    store(view, command.directory / "arms.h5")
    drawn = command.drawn("plot", "arms.h5", "-o", "one.png")
    assert (drawn.returncode, drawn.stderr) == (0, "")
    assert "period and amplitude over F and k2" in drawn.stdout
    named = command.drawn("plot", "arms.h5", "--what", "maps", "-o", "two.png")
    assert (named.returncode, named.stderr) == (0, "")
