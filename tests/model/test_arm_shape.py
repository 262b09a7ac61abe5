"""Arms that taper or have segments: factors by hand, limits that are uniform, units, and each refusal."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rodsweep.errors import InputError
from rodsweep.model.arm.arm import SlenderArm
from rodsweep.model.arm.drag import (
    DRAG_ESTIMATE_NAMES,
    cox_drag_over_viscosity,
    gray_hancock_drag_over_viscosity,
    lighthill_drag_over_viscosity,
)
from rodsweep.model.arm.geometry import MAX_RADIUS_RATIO_OF_PROFILE_ROWS
from rodsweep.model.arm.neglected import SELF_BUCKLING_WEIGHT, neglected_effects, smallest_drag

ROUND = {"length": "10 cm", "radius": "5 mm", "young": "100 kPa", "viscosity": "50 Pa s", "pressure": "2 kPa"}
PARAMETERS = ("k1", "k2", "gamma3", "gamma1", "F", "tau2", "taper", "material", "crushing_force")
SEVEN = "7 cm: radius 5 mm"
FLUID = {"viscosity": "50 Pa s"}
"""The fluid alone: what an arm in segments needs beside them."""


def uniform(**changes):
    given = {name: value for name, value in (ROUND | changes).items() if value is not None}
    return SlenderArm(**given)


def segmented(*segments, **changes):
    return SlenderArm(segments=segments, **FLUID | changes)


@pytest.mark.parametrize(
    "changes",
    [
        {"tip_radius": "5 mm"},
        {"tip_radius": 0.005},
        {"radius": None, "segments": ["5 cm: radius 5 mm", "5 cm: radius 5 mm"]},
        {
            "radius": None,
            "length": None,
            "segments": [{"length": 0.03, "radius": 0.005}, "7 cm: radius 5 mm"],
        },
        {"radius": None, "young": None, "segments": ["100 mm: radius 0.5 cm, young 0.1 MPa"]},
    ],
)
def test_an_arm_alike_all_along_is_the_uniform_arm(changes):
    other = uniform(**changes)
    assert other.is_uniform_and_linear
    for name in PARAMETERS:
        value = getattr(uniform(), name)
        assert getattr(other, name) == (pytest.approx(value, rel=1e-14) if name != "material" else value)


def test_a_cone_has_the_stiffness_of_its_base_and_the_face_of_its_tip():
    cone = uniform(tip_radius="2.5 mm", pressure="0.4 kPa")
    for name in ("k1", "k2", "gamma3", "gamma1", "tau2"):
        assert getattr(cone, name) == getattr(uniform(), name)
    assert cone.taper == 0.5
    assert cone.tip_force == pytest.approx(400 * math.pi * 0.0025**2, rel=1e-12)
    assert cone.crushing_force == pytest.approx(cone.k1 / 4, rel=1e-12)
    assert cone.load_scale == pytest.approx(cone.force_scale / (math.pi * 0.0025**2), rel=1e-12)


@pytest.mark.parametrize("taper", [0.01, 0.1, 0.5, 0.9, 2.0, 8.0])
def test_the_drags_of_a_cone_are_those_of_its_local_radius(taper):
    radius = 0.1 / (20 * max(1, taper))
    cone = uniform(radius=radius, tip_radius=taper * radius, pressure=None)
    u = np.linspace(0, 1, 1001)[1:-1]
    values = {name: cone.parameter(name) for name in ("k1", "k2", "gamma3", "taper")}
    for number, form, error in (
        (0, cox_drag_over_viscosity, 3e-4),
        (1, gray_hancock_drag_over_viscosity, 3e-4),
        (3, lighthill_drag_over_viscosity, 6e-4),
    ):
        local = cone.material_with_drag(cone.base_drag_estimates[number]).local_coefficients(0.0, values, u)
        slenderness = 0.1 / (radius * (1 - (1 - taper) * u))
        across = np.array([form(each)[1] for each in slenderness])
        assert local.gamma2 == pytest.approx(across / form(0.1 / radius)[1], rel=error)
    assert local.gamma3 == pytest.approx(values["gamma3"] * (1 - (1 - taper) * u) ** 2, rel=1e-12)
    radii = 1 - (1 - taper) * cone.material.breaks
    steps = np.maximum(radii[1:] / radii[:-1], radii[:-1] / radii[1:])
    assert steps.max() <= MAX_RADIUS_RATIO_OF_PROFILE_ROWS * (1 + 1e-12)


def test_factors_of_segments_by_hand():
    """A solid base of 6 mm and 80 kPa, and a tube of 4 and 2 mm and 200 kPa; Cowper's kappa, drag of Cox."""
    arm = segmented("4 cm: radius 6 mm, young 80 kPa", "6 cm: radius 4 mm, inner radius 2 mm, young 200 kPa")
    u, rows = arm.material.profile.u, arm.material.profile.rows
    assert u == pytest.approx((0, 0.4, 0.4, 1), rel=1e-14)
    assert rows[0] == rows[1] == (1.0,) * 6
    kappa = 9 * 1.5625 / (10 * 1.5625 + 26 * 0.25)
    k1 = 2.5 * (16 - 4) / 36
    axial, across = (
        thin / thick
        for thin, thick in zip(
            cox_drag_over_viscosity(0.1 / 0.004), cox_drag_over_viscosity(0.1 / 0.006), strict=True
        )
    )
    expected = (k1, k1 * kappa / 0.9, 2.5 * (256 - 16) / 1296, axial, across, 16 / 36)
    assert rows[2] == pytest.approx(expected, rel=1e-12)
    assert rows[2] == rows[3]
    assert arm.k1 == pytest.approx(4 * (0.1 / 0.006) ** 2, rel=1e-12)
    assert arm.bending_stiffness == pytest.approx(80e3 * math.pi * 0.006**4 / 4, rel=1e-12)
    assert arm.pressure_scale == pytest.approx(arm.force_scale / (math.pi * 0.004**2), rel=1e-12)


def test_many_segments_have_the_coefficients_of_a_cone():
    """In SI units at the middle of every segment, whose radius is that of the cone there."""
    count, cone = 25, uniform(tip_radius="2 mm", pressure=None)
    middles = (np.arange(count) + 0.5) / count
    radii = 5 - 3 * middles
    steps = segmented(*(f"4 mm: radius {float(r)!r} mm" for r in radii), young="100 kPa")
    for number in range(len(DRAG_ESTIMATE_NAMES)):
        found = []
        for arm in (cone, steps):
            values = {name: arm.parameter(name) for name in ("k1", "k2", "taper")}
            drag = arm.base_drag_estimates[number]
            own = arm.material_with_drag(drag).local_coefficients(
                0.0, values | {"gamma3": arm.gamma3_with(drag)}, middles
            )
            stiffness, L = arm.bending_stiffness, arm.si.length
            found.append(
                (
                    own.c2 * L**2 / stiffness,
                    own.c3 / stiffness,
                    own.gamma2 * drag.gamma2,
                    own.gamma3 * drag.gamma2 * L**2,
                )
            )
        for of_cone, of_steps, tolerance in zip(*found, (1e-9, 1e-9, 3e-4, 1e-9), strict=True):
            assert of_steps == pytest.approx(of_cone, rel=tolerance)


def test_units_of_segments_do_not_matter():
    same = segmented("4 cm: radius 6 mm, young 80 kPa", "6 cm: radius 4 mm, young 0.1 MPa")
    other = segmented(
        {"length": 0.04, "radius": 0.006, "young": "0.08 MPa"},
        {"length": "60 mm", "radius": "0.4 cm", "young": 1e5},
    )
    again = segmented(*other.segments)
    assert again == other
    for arm in (other, again):
        assert arm.material.profile.rows[-1] == pytest.approx(same.material.profile.rows[-1], rel=1e-13)
        assert [getattr(arm, n) for n in ("k1", "k2", "gamma3")] == pytest.approx(
            [getattr(same, n) for n in ("k1", "k2", "gamma3")], rel=1e-13
        )


def test_effects_are_those_of_the_section_where_they_are_largest():
    """Against two uniform arms: the thicker has more mass and drag, the thinner is crushed first."""
    arm = segmented("5 cm: radius 6 mm", "5 cm: radius 4 mm", young="100 kPa", density_difference=10.0)
    thick, thin = (
        uniform(radius=radius, pressure=None, density_difference=10.0) for radius in ("6 mm", "4 mm")
    )
    assert arm.crushing_force * arm.force_scale == pytest.approx(thin.k1 * thin.force_scale, rel=1e-12)
    own = {e.name: float(e.value) for e in neglected_effects(arm, 2.0, 1.0)}
    found = [
        {e.name: float(e.value) for e in neglected_effects(each, 2.0, 1.0, drag=smallest_drag(each))}
        for each in (thick, thin)
    ]
    for name in ("inertia of the arm", "inertia of the fluid", "Reynolds number"):
        assert own[name] == pytest.approx(max(each[name] for each in found), rel=1e-12)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"tip_radius": "2 mm"},
        {"tip_radius": "8 mm"},
        {
            "radius": None,
            "segments": ["3 cm: radius 6 mm, inner_radius 3 mm", "7 cm: radius 3 mm, young 1 MPa"],
        },
    ],
)
def test_an_upright_arm_buckles_under_the_weight_that_is_stated(changes):
    """Integrated from the tip with theta' = m/(E I), m' = -W theta: theta vanishes at the base."""
    arm = uniform(**changes, pressure=None)
    shape, weight = arm.geometry, 1 / arm.geometry.weight_over_buckling_weight(1.0)

    def section(x):
        if arm.tip_radius is None:
            station = next(
                each for each in shape.stations if each.end_position * shape.length >= x * (1 - 1e-15)
            )
            return station.section.area, station.young * station.section.second_moment
        radius = arm.si.radius * (1 - (1 - arm.taper) * x / shape.length)
        return math.pi * radius**2, arm.si.young * math.pi * radius**4 / 4

    def slopes(x, state):
        area, stiffness = section(x)
        beyond, theta, moment = state
        return [-weight * area, moment / stiffness, -beyond * theta]

    state = [0.0, 1.0, 0.0]
    ends = [0.0] if arm.tip_radius else [0.0, *(each.end_position for each in shape.stations[:-1])]
    places = [*(end * shape.length for end in ends), shape.length]
    for low, high in zip(places[-2::-1], places[:0:-1], strict=True):
        inside = high - 1e-12 * shape.length
        state = solve_ivp(slopes, (inside, low + 1e-12), state, rtol=1e-10, atol=1e-14).y[:, -1]
    assert abs(state[1]) < 1e-3
    if not changes:
        assert weight == pytest.approx(
            SELF_BUCKLING_WEIGHT * arm.force_scale / (math.pi * 25e-6 * 0.1), rel=1e-4
        )


SEGMENTS = {"radius": None, "length": None}


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"tip_radius": "0 mm"}, "tip_radius = '0 mm' is not above 0"),
        ({"tip_radius": -0.001}, "tip_radius = -0.001 m is not above 0"),
        ({"tip_radius": "3"}, "tip_radius = '3' has no unit"),
        (
            {"tip_radius": "0.04 mm"},
            "tip_radius = '0.04 mm' is 0.008 of the radius; the ratio must be from 0.01",
        ),
        ({"tip_radius": "3 mm", "inner_radius": "1 mm"}, "tip_radius = '3 mm' and inner_radius = '1 mm' are"),
        (
            {"radius": None, "width": "5 mm", "height": "5 mm", "tip_radius": "3 mm"},
            "tip_radius = '3 mm' needs a radius",
        ),
        ({"tip_radius": "20 mm"}, "length = '10 cm' is 5 radii, with tip_radius = '20 mm'; .* at least 10"),
        (
            {"tip_radius": "1 mm", "pressure": "100 kPa"},
            "pressure = '100 kPa' crushes the weakest section of the arm; the load on a linear material",
        ),
        ({"length": None}, "length is missing; write it as in '10 cm'"),
        ({"young": None}, "young is missing; write it as in '100 kPa'"),
        ({"law": ["linear"]}, "law = \\['linear'\\] is not a text"),
        ({"section": 3}, "section = 3 is not a text"),
        ({"law": "hooke"}, "law = hooke is not known; it must be linear or neo_hookean"),
        ({"section": "swelling"}, "section = swelling is not known for law = linear; it must be fixed"),
        (
            {"law": "neo_hookean", "section": "swelling", "poisson": 0.49},
            "poisson = 0.49 contradicts section = swelling, .*; poisson must be 0.5, or section fixed",
        ),
        ({"segments": ["10 cm: radius 5 mm"]}, "radius = '5 mm' and segments are both given"),
        (
            {"segments": ["4 cm: radius 6 mm"], "radius": None},
            "length = '10 cm' is not the sum .*, 4 cm",
        ),
        (
            {"radius": None, "tip_radius": "3 mm", "segments": ["10 cm: radius 5 mm"]},
            "tip_radius = '3 mm' and segments are both given",
        ),
        (SEGMENTS | {"segments": []}, "segments has no segment"),
        (SEGMENTS | {"segments": 3}, "segments = 3 is not a list"),
        (SEGMENTS | {"segments": ["9 cm: radius 6 mm"] * 101}, "segments: 101 are given; .* at most 100"),
        (
            SEGMENTS | {"segments": ["9 cm radius 6 mm"]},
            "segments, number 1: '9 cm radius 6 mm' is no",
        ),
        (SEGMENTS | {"segments": ["9 cm: young 6 kPa"]}, "segments, number 1: radius is missing"),
        (SEGMENTS | {"segments": [{"radius": "6 mm"}]}, "segments, number 1: length is missing"),
        (
            SEGMENTS | {"segments": ["9 cm: radius 6 mm", "1 cm: radius 6 mm, viscosity 1 Pa s"]},
            "segments, number 2: unknown key viscosity; a segment has length, radius, inner_radius, young",
        ),
        (
            SEGMENTS | {"segments": ["9 cm: radius 6 mm, radius 5 mm"]},
            "segments, number 1: radius is given twice",
        ),
        (SEGMENTS | {"segments": ["9 cm: radius 6 mm, "]}, "segments, number 1: '' is not a quantity"),
        (
            SEGMENTS | {"segments": ["9 cm: radius 0 mm"]},
            "segments, number 1: radius = '0 mm' is not above",
        ),
        (
            SEGMENTS | {"segments": ["0 cm: radius 5 mm"]},
            "segments, number 1: length = '0 cm' is not above",
        ),
        (
            SEGMENTS | {"segments": ["9 cm: radius 6 kPa"]},
            "segments, number 1: radius = '6 kPa' is not m",
        ),
        (
            SEGMENTS | {"segments": ["9 cm: radius 6 mm, inner_radius 6 mm"]},
            "segments, number 1: inner_radius = '6 mm' is not below radius = '6 mm'",
        ),
        (
            SEGMENTS | {"segments": ["9 cm: radius 5 mm, young 1 kPa", "1 cm: radius 5 mm"], "young": None},
            "segments, number 2: young is missing; give young for this segment or for the arm",
        ),
        (
            SEGMENTS | {"segments": ["1 cm: radius 5 mm"]},
            "segments: their length is 2 radii, with a largest radius of 0.005 m; the drag of a slender arm "
            "needs at least 10",
        ),
        ({"radius": 5}, "length = '10 cm' is 0.02 radii, with radius = 5 m; the drag of a slender arm"),
        ({"radius": 5, "tip_radius": "2 m"}, "length = '10 cm' is 0.02 radii, with radius = 5 m;"),
        (
            {"radius": None, "width": 5, "height": "3 m"},
            "length = '10 cm' is 0.05 radii, with an equivalent radius of 2 m;",
        ),
        (
            SEGMENTS | {"segments": ["9 cm: diameter 6 mm"]},
            "segments, number 1: unknown key diameter; give radius, half of it",
        ),
        (
            SEGMENTS | {"segments": [{"length": "9 cm", "outer_diameter": "6 mm"}]},
            "segments, number 1: unknown key outer_diameter; give radius, half of it",
        ),
        # A logarithm of the drag of this arm is 0.
        ({"length": "5 cm", "radius": "9 mm"}, "length = '5 cm' is 5.56 radii"),
    ],
)
def test_bad_shapes_and_laws_are_refused_in_one_sentence(changes, sentence):
    with pytest.raises(InputError, match=f"^{sentence}") as refused:
        uniform(**changes)
    assert "\n" not in str(refused.value)
