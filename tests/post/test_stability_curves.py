"""What the thresholds on the bars of single rods are called."""

from pathlib import Path

import numpy as np
import pytest

from rodsweep.post.figures.stability.class_bars import draw_class_bars
from rodsweep.results.file.view import ResultView
from rodsweep.results.layouts.thresholds import CROSSING_KINDS


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
