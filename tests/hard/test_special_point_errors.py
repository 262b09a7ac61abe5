"""Stated errors of special points on branches, against the same points on finer meshes."""

import numpy as np
import pytest
from surveyed import RODS, few, survey_only

from rodsweep.model.rod import Rod
from rodsweep.solve.branch.branch_limits import BranchRequest
from rodsweep.solve.branch.branches import solve_branches
from rodsweep.solve.branch.special import detection

REFERENCE = 1e-11
"""Relative accuracy of the parameter at the points on finer meshes."""
ROUNDING = np.array([3e-13, 1e-10, 3e-10])
"""Relative errors of parameter, period and largest y that may be rounding errors: the place of a fold along
its branch is uncertain by 1e-10, which has no effect on the parameter."""
CLOSE = 30.0
"""How many times larger than the error estimates are in the median at most."""

ROD = {"k2": 1e4, "gamma3": 1e-4}
CASES = {
    "Fig. 2c": ("F", {"k1": 200.0, **ROD}, (0.0, 199.9), 1e-7),
    "along k1": ("k1", {"F": 90.259, "k1": 188.71, "k2": 1371.3, "gamma3": 1.125e-4}, (103.0, 566.0), 1e-5),
    "a fold beside its Hopf point": ("F", {"k1": 149.618, **ROD}, (0.0, 149.0), 1e-6),
    "torus": ("F", {"k1": 2387.4, "k2": 66.73, "gamma3": 4.7e-4, "taper": 0.868}, (0.0, 140.0), 1e-5),
    "lopsided": ("F", {"k1": 30.0, "k2": 0.5, "gamma3": 0.1}, (0.0, 24.0), 1e-5),
}


def random_case(index):
    """The case of that number: most of these branches have a fold."""
    random = np.random.default_rng([31, index])
    k1, F = random.uniform(138, 290), random.uniform(70, 110)
    rod = {"F": F, "k1": k1, "k2": 10 ** random.uniform(3.5, 5), "gamma3": 10 ** random.uniform(-5, -2.3)}
    if random.random() < 0.3:
        rod["taper"] = random.uniform(0.7, 1.3)
    along, span = ("F", (0.0, 0.95 * k1)) if index % 2 else ("k1", (max(k1 / 3, 1.1 * F), 3 * k1))
    return along, rod, span, float(random.choice([1e-5, 1e-7, 1e-9]))


def numbers(point):
    """Parameter, period and largest y of a special point, and their relative errors, (2, 3)."""
    p = point.parameter_value
    return np.array(
        [
            [p, point.period, point.tip_y_max],
            [point.error / abs(p), point.period_error, point.tip_y_max_error],
        ]
    )


def errors_and_estimates(case, monkeypatch):
    """Relative errors of parameter, period and largest y at all located special points of a rod, and their
    estimates, (points, 3) each; an estimate has the estimate of the finer mesh added."""
    along, rod, span, accuracy = case
    locate, errors, estimates = detection.special_point_between, [], []

    def compared(kind, start, end, accuracy):
        points = [locate(kind, start, end, relative) for relative in (accuracy, REFERENCE)]
        if not any(point.message for point in points):
            (values, stated), (exact, finer_stated) = map(numbers, points)
            errors.append(np.abs(values / exact - 1))
            estimates.append(stated + finer_stated)
        return points[0]

    with monkeypatch.context() as patched:
        patched.setattr(detection, "special_point_between", compared)
        solve_branches(Rod(**{"F": 0.0, **rod}), BranchRequest(along, *span, accuracy, False, 300, 50))
    return np.reshape(errors, (-1, 3)), np.reshape(estimates, (-1, 3))


@pytest.mark.long
@pytest.mark.parametrize("case", few([*CASES.values()], 3), ids=few([*CASES], 3))
def test_special_points_are_as_near_to_those_of_finer_meshes_as_they_say(case, monkeypatch):
    errors, estimates = errors_and_estimates(case, monkeypatch)
    assert len(errors) > 0
    assert (errors <= estimates).all()
    # Each estimate alone may be loose where errors of two meshes agree by chance.
    assert (estimates <= 10 * CLOSE * np.maximum(errors, ROUNDING)).all()


@survey_only
def test_estimates_at_special_points_of_random_rods_are_close_to_the_errors(monkeypatch):
    found = [errors_and_estimates(random_case(index), monkeypatch) for index in range(RODS)]
    errors, estimates = (np.concatenate(part) for part in zip(*found, strict=True))
    assert (errors <= estimates).all()
    is_known = errors > ROUNDING
    assert is_known.sum() > RODS / 2
    assert np.median(estimates[is_known] / errors[is_known]) <= CLOSE
