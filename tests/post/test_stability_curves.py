"""Which Hopf curves of a phase diagram bound the stable rods, and what figures call them."""

from pathlib import Path

import numpy as np
import pytest

from rodsweep.post.figures.stability.class_bars import draw_class_bars
from rodsweep.post.figures.stability.diagram_curves import labelled_curve_paths, plane_force_text
from rodsweep.post.plane_curves import PlaneParameters, is_stability_boundary_by_curve
from rodsweep.results.file.view import ResultView
from rodsweep.results.layouts.thresholds import CROSSING_KINDS

K2 = np.array([1.0, 2.0, 3.0])


def diagram():
    """Over (k1, k2) at F = 50: curve 1 is that of a second pair, longer than curve 2, the boundary."""
    hopf, k2 = CROSSING_KINDS.index("hopf_reverse"), np.linspace(1, 3, 21)
    again = CROSSING_KINDS.index("restabilization")
    v = {
        "curve_number": np.repeat([1, 2], 21),
        "curve_kind": np.ones(42, "i1"),
        "curve_k1": np.concatenate([100 + 40 * k2, 300 + 10 * k2]),
        "curve_k2": np.tile(k2, 2),
        "crossing_kind": np.array([[hopf, again]] * 3).reshape(1, 3, 1, 2),
        "crossing_at": np.stack([100 + 40 * K2, 300 + 10 * K2], axis=-1).reshape(1, 3, 1, 2),
        "unstable_after": np.array([[2, 0]] * 3).reshape(1, 3, 1, 2),
        "status": np.zeros((1, 3, 1)),
        "F": np.array([50.0]),
        "k2": K2,
        "gamma3": np.array([1e-4]),
    }
    return ResultView(Path("f.h5"), {"task": "phase_diagram"}, v, ("F", "k2", "gamma3"), {0: "ok"}, 0)


def test_the_boundary_is_the_curve_on_which_the_rows_change_their_stability():
    view = diagram()
    assert is_stability_boundary_by_curve(view, PlaneParameters("k1", "k2")) == {1: False, 2: True}
    (named,) = labelled_curve_paths(view, 1, PlaneParameters("k1", "k2"))
    assert named[:, 0].tolist() == view.variables["curve_k1"][21:].tolist()


def test_a_plane_without_force_names_the_force_at_which_it_lies():
    assert plane_force_text(diagram(), PlaneParameters("k1", "k2")) == " = 50"
    assert plane_force_text(diagram(), PlaneParameters("F", "k2")) == ""


@pytest.mark.parametrize("further", [0, 2])
def test_only_the_first_hopf_point_of_a_bar_is_called_critical(further):
    kinds = [CROSSING_KINDS.index(kind) for kind in ("onset", *["hopf"] * (1 + further))]
    v = {
        "status": np.zeros((1, 1, 1), "i1"),
        "F_end": np.full((1, 1, 1), 200.0),
        "crossing_F": np.array([22.0, 37.6954, 90.0, 174.624][: len(kinds)]).reshape(1, 1, 1, -1),
        "crossing_kind": np.array(kinds).reshape(1, 1, 1, -1),
        "unstable_after": np.array([0, 2, 4, 6][: len(kinds)]).reshape(1, 1, 1, -1),
        "crossing_count": np.full((1, 1, 1), len(kinds)),
        "open_from": np.full((1, 1, 1), np.nan),
        "open_to": np.full((1, 1, 1), np.nan),
        "k1": np.array([1e4]),
        "k2": np.array([1e2]),
        "gamma3": np.array([1e-2]),
    }
    view = ResultView(
        Path("t.h5"), {"task": "thresholds", "title": ""}, v, ("k1", "k2", "gamma3"), {0: "ok"}, 0
    )
    words = [text.get_text() for text in draw_class_bars(view).legends[0].get_texts()]
    critical = [word for word in words if "{**}" in word]
    assert [word.split(" = ")[1] for word in critical] == ["37.6954"]
    assert [word for word in words if "further" in word] == (
        ["further Hopf points = 90.0000, 174.624"] if further else []
    )
