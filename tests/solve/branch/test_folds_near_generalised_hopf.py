"""Folds of cycles close to a generalised Hopf point, where the force is nearly constant along the branch."""

import numpy as np
import pytest

import rodsweep as rs
from rodsweep.solve.branch.special.special_curves import CurvePoint, extrapolated_hopf_end

F, K1 = 84.4786266155, 149.61689161180
"""The generalised Hopf point with k2 = 1e4, gamma3 = 1e-4, of configs/generalised_hopf.yaml."""
SQUARED_Y_PER_K1 = 3.580e-3
"""Squared largest y of the folds, divided by k1 - K1 near K1; by another code, from cycles at
K1 (1 + 1e-4) and K1 (1 + 2e-5)."""


@pytest.mark.parametrize("relative_distance", [3e-7, 2e-6, 4e-6])
def test_the_size_of_a_fold_lies_within_its_error_or_the_fold_is_not_located(relative_distance):
    """Rounding decides whether the nearest fold is located; its size lies within the stated error anyway."""
    distance = relative_distance * K1
    branch = rs.Rod(k1=K1 + distance, k2=1e4, gamma3=1e-4).branch(start=83, stop=86, accuracy=1e-6)
    (fold,) = branch.special_points[branch.special_points.special_kind == "fold"].itertuples()
    y = (SQUARED_Y_PER_K1 * distance) ** 0.5
    assert abs(fold.special_tip_y_max - y) <= fold.special_tip_y_max_error * fold.special_tip_y_max
    is_unlocated = "the special point (fold) is not located" in branch.message
    assert branch.status.name == ("special_undecided" if is_unlocated else "ok")


@pytest.mark.parametrize("count", [2, 3])
def test_the_end_at_a_hopf_point_follows_from_few_points(count):
    """To first order force, k1 and period are linear in the squared amplitude."""
    sizes = np.array([3e-3, 2e-3, 1e-3])[:count]
    points = [
        CurvePoint(
            parameter_value=F + 0.3 * y**2,
            row_parameter_value=K1 + y**2 / SQUARED_Y_PER_K1,
            row_coordinate=0.5,
            error=1e-9,
            period=6.48e-3 * (1 - y**2),
            tip_y_max=y,
        )
        for y in sizes
    ]
    end = extrapolated_hopf_end(points)
    assert (end.parameter_value, end.row_parameter_value) == pytest.approx((F, K1), rel=1e-13)
    assert end.period == pytest.approx(6.48e-3, rel=1e-13)
    assert 1e-8 <= end.error < 1e-4
    assert extrapolated_hopf_end(points[:1]) is None
