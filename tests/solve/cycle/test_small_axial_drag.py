"""Cycles of rods with little axial drag, down to none, whose axial velocity is an unknown of the solver."""

from dataclasses import replace

import numpy as np
import pytest

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.stress.form import VELOCITY_ELIMINATION_SETTINGS, StressForm
from rodsweep.model.material.profile import FACTOR_NAMES, Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.branch.branch_limits import BranchRequest
from rodsweep.solve.branch.branches import solve_branches
from rodsweep.solve.branch.special.special_point import SpecialPointKind
from rodsweep.solve.branch.status import BranchStatus
from rodsweep.solve.cycle.by_integration import solve_by_integration
from rodsweep.solve.cycle.cycle_outcome import CycleRequest
from rodsweep.solve.cycle.limit_cycle import solve_cycle
from rodsweep.solve.cycle.status import CycleStatus
from rodsweep.solve.cycle.transient.motion_mesh import MOTION_MESH_SETTINGS, rod_for_time_integration

ROD = Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0)
STIFF = Rod(F=50.0, k1=1e8, k2=1e4, gamma3=1e-8, gamma1=1e-6)
LIMIT = VELOCITY_ELIMINATION_SETTINGS.min_eliminated_axial_drag
FOLD = 27.4204256223
"""Fold of the branch from the first Hopf point of ROD with the axial drag 1e-6, +- 9e-10, by the form in
which the axial velocity is eliminated."""
REQUEST = CycleRequest(
    amplitude=0.01, harmonics=8, samples=0, shapes=0, nodes=0, most_periods=200, accuracy=1e-5
)


def period_and_y(rod, accuracy=1e-8):
    found = solve_cycle(rod, replace(REQUEST, accuracy=accuracy))
    assert found.status == CycleStatus.cycle, found.message
    return np.array([found.measures.period, found.measures.tip_y_max])


def falling_to(factor):
    """Material of an arm whose axial drag falls to `factor` at the tip."""
    rows = [[1.0] * len(FACTOR_NAMES) for _ in range(3)]
    for row, value in zip(rows, (1.0, factor**0.5, factor), strict=True):
        row[FACTOR_NAMES.index("gamma1")] = value
    return RodMaterial(profile=Profile((0.0, 0.5, 1.0), tuple(map(tuple, rows))))


@pytest.mark.long
@pytest.mark.parametrize("factor", [None, 0.01])
def test_the_two_forms_have_the_same_cycle(factor):
    arm = replace(ROD, material=falling_to(factor)) if factor else ROD
    base = LIMIT / (factor or 1)
    with_v1, without = (replace(arm, gamma1=base * (1 + sign * 1e-9)) for sign in (-1, 1))
    forms = [StressForm(rod, uniform_mesh(1, 8)).unknown_velocity_components for rod in (with_v1, without)]
    assert forms == [(0,), ()]
    assert period_and_y(with_v1) == pytest.approx(period_and_y(without), rel=2e-8)


@pytest.mark.long
def test_period_and_amplitude_are_linear_in_a_small_drag_down_to_none():
    drags = [4e-4, 2e-4, 1e-5, 1e-300]
    large, small, tiny, none = (period_and_y(replace(ROD, gamma1=drag)) for drag in drags)
    slope = (large - small) / (drags[0] - drags[1])
    assert tiny == pytest.approx(none + slope * drags[2], rel=1e-7)
    # The drag of 2e-4 is small, too: what is left is quadratic in the drag.
    assert small == pytest.approx(none + slope * drags[1], rel=1e-6)


@pytest.mark.long
def test_an_arm_whose_axial_drag_falls_to_little_beats():
    """From 1e-3 at the base to 1e-6 at the tip. In the form without v1 Newton's method found no cycle."""
    arm = replace(ROD, gamma1=1e-3, material=falling_to(1e-3))
    assert period_and_y(arm, 1e-6) == pytest.approx(period_and_y(arm, 1e-8), rel=2e-6)
    assert period_and_y(arm, 1e-6) == pytest.approx(period_and_y(replace(ROD, gamma1=1e-14)), rel=1e-2)


@pytest.mark.parametrize(("gamma1", "factor"), [(1.0, 1e-9), (1e-3, 1e-9), (1e-9, 1e-3), (1.0, 0.5)])
def test_no_part_of_an_integrated_arm_has_less_axial_drag_than_can_be_integrated(gamma1, factor):
    """The drag of the base alone was raised."""
    arm = replace(ROD, gamma1=gamma1, material=falling_to(factor))
    integrated = rod_for_time_integration(arm)
    least = MOTION_MESH_SETTINGS.min_axial_drag
    u = np.linspace(0.01, 0.99, 50)
    drags = [
        rod.gamma1 * rod.material.profile.factors_at(u)[FACTOR_NAMES.index("gamma1")]
        for rod in (integrated, arm)
    ]
    assert (drags[0] >= least * (1 - 1e-12)).all()
    assert integrated.least_axial_drag == pytest.approx(max(arm.least_axial_drag, least), rel=1e-12)
    assert integrated.gamma1 == max(gamma1, least)
    assert (abs(drags[0] - drags[1]) <= least).all()  # what lies between the rows moves little
    others = [name != "gamma1" for name in FACTOR_NAMES]
    assert (integrated.material.profile.factors_at(u)[others] == 1).all()


def test_a_rubber_arm_beats_at_a_drag_at_which_the_eliminated_form_finds_no_cycle():
    jump = [[1.0] * len(FACTOR_NAMES) for _ in range(2)]
    jump[1][FACTOR_NAMES.index("gamma1")] = 0.1
    jump[1][FACTOR_NAMES.index("k3")] = 0.7
    rows = tuple(tuple(row) for row in (jump[0], jump[0], jump[1], jump[1]))
    material = RodMaterial("neo_hookean", "swelling", Profile((0.0, 0.5, 0.5, 1.0), rows))
    arm = Rod(F=40.0, k1=1e4, k2=30.0, gamma3=1e-4, gamma1=1e-3, material=material)
    assert period_and_y(arm) == pytest.approx(period_and_y(arm, 1e-5), rel=2e-5)


def test_a_stiff_rod_with_little_axial_and_rotational_drag_beats():
    """With the period extrapolated from two drags at which the axial velocity is eliminated."""
    drags = [1.01 * LIMIT, 1.5 * LIMIT]
    near, far = (period_and_y(replace(STIFF, gamma1=drag), 1e-5)[0] for drag in drags)
    none = near - (far - near) / (drags[1] - drags[0]) * drags[0]
    # What is left is quadratic in the drags, 2e-3 and 3e-3.
    assert period_and_y(STIFF, 1e-5)[0] == pytest.approx(none, rel=2e-3)


@pytest.mark.parametrize("gamma1", [1e-6, 1e-14])
def test_branches_start_at_hopf_points_and_have_their_folds(gamma1):
    request = BranchRequest(
        along="F", start=0.0, stop=28.0, accuracy=1e-5, certify=True, cycles=50, special=9
    )
    found = solve_branches(replace(ROD, F=0.0, gamma1=gamma1), request)
    assert found.status == BranchStatus.ok, found.message
    (fold,) = (p for p in found.curves[0].special_points if p.kind == SpecialPointKind.fold)
    assert fold.parameter_value == pytest.approx(FOLD, abs=2e-9 if gamma1 == 1e-6 else 2e-6)


@pytest.mark.parametrize("distance", [0.01, 0.1])
def test_a_fast_growing_branch_is_followed_from_its_hopf_point(distance):
    """By the square-root law y would be 1.2 and 3.9 L: Newton's method diverged from such orbits."""
    hopf = 16.01750598
    rod = Rod(
        F=hopf * (1 + distance),
        k1=13659.3799413271,
        k2=17.1484088792414,
        gamma3=0.03176726705,
        gamma1=0.0359586,
    )
    from_hopf, from_mode = (solve_cycle(rod, replace(REQUEST, start=start)) for start in ("hopf", "mode"))
    assert from_hopf.status == from_mode.status == CycleStatus.cycle
    assert from_hopf.measures.tip_y_max == pytest.approx(from_mode.measures.tip_y_max, rel=2e-5)


@pytest.mark.parametrize(
    ("gamma3", "factor", "taper"), [(1e-3, 1e-9, 1.0), (1e-2, 1e-5, 0.2), (0.0, 1.0, 1.0)]
)
def test_no_row_of_an_integrated_arm_has_less_rotational_drag_than_can_be_integrated(gamma3, factor, taper):
    """The drag of the base alone was raised: the integrator found no time step with an acceptable error."""
    rows = [[1.0] * len(FACTOR_NAMES) for _ in range(4)]
    for row in rows[2:]:
        row[FACTOR_NAMES.index("gamma3")] = factor
    material = RodMaterial(profile=Profile((0.0, 0.5, 0.5, 1.0), tuple(map(tuple, rows))))
    integrated = rod_for_time_integration(replace(ROD, gamma3=gamma3, taper=taper, material=material))
    column = FACTOR_NAMES.index("gamma3")
    drags, given = (
        [
            drag * row[column] * (1 - (1 - taper) * u) ** 2
            for u, row in zip(profile.u, profile.rows, strict=True)
        ]
        for drag, profile in ((integrated.gamma3, integrated.material.profile), (gamma3, material.profile))
    )
    least = MOTION_MESH_SETTINGS.min_rotational_drag
    assert drags == pytest.approx([max(drag, least) for drag in given], rel=1e-12)


@pytest.mark.long
def test_an_arm_with_hardly_any_rotational_drag_near_its_tip_is_integrated():
    """Both ways to the cycle agree; the integrator found no time step with an acceptable error."""
    rows = [[1.0] * len(FACTOR_NAMES) for _ in range(4)]
    for row in rows[2:]:
        row[FACTOR_NAMES.index("gamma3")] = 1e-6
    material = RodMaterial(profile=Profile((0.0, 0.5, 0.5, 1.0), tuple(map(tuple, rows))))
    arm = Rod(F=45.0, k1=1e4, k2=1e2, gamma3=1e-3, material=material)
    integrated = solve_by_integration(arm, REQUEST)
    collocated = solve_cycle(arm, REQUEST)
    assert collocated.status == CycleStatus.cycle
    assert integrated.measures is not None, integrated.message
    assert integrated.measures.period == pytest.approx(collocated.measures.period, rel=2e-4)


@pytest.mark.parametrize(
    "rod",
    [
        Rod(F=41.71170139482839, k1=10254.55, k2=131.5513, gamma3=5.79084e-3, gamma1=9.35741e-3),
        Rod(F=42.73824356728793, k1=1330.789, k2=305.63, gamma3=3.35181e-3, gamma1=3.184137e-3),
        Rod(F=42.37503910773828, k1=3477.883, k2=7441.525, gamma3=5.41233e-3, gamma1=1.164375e-4),
        Rod(F=40.45242119989657, k1=7421.1, k2=898.714, gamma3=2.36832e-3, gamma1=1.3362e-6),
    ],
    ids=lambda rod: f"{rod.gamma1:.0e}",
)
def test_a_branch_that_rises_steeply_is_followed_from_its_hopf_point(rod):
    """The status was `not_settled`, because the branch "ends or has a fold"; it has none."""
    request = replace(REQUEST, start="hopf", accuracy=1e-6)
    cycles = [solve_cycle(rod, each) for each in (request, replace(request, start="mode"))]
    assert [cycle.status for cycle in cycles] == [CycleStatus.cycle] * 2, cycles[0].message
    hopf, mode = (cycle.measures for cycle in cycles)
    assert hopf.period == pytest.approx(mode.period, rel=4e-6)
    assert hopf.tip_y_max == pytest.approx(mode.tip_y_max, rel=4e-6)
