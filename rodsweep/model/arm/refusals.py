"""Input checks of an arm: contradictory or missing quantities, and arms that are not slender."""

from math import inf
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import InputError, short_repr
from ..material.laws import law_of
from ..material.profile import MIN_ROW_DISTANCE
from ..parameters import MAX_TAPER, MIN_TAPER
from ..units import unit_of, value_in_unit
from .drag import ALL_DRAG_ESTIMATES_NAME, DRAG_ESTIMATE_NAMES, MIN_FORMULA_SLENDERNESS
from .quantities import GIVEN_QUANTITIES, SECTION_SIZE_NAMES, UNITS_AND_EXAMPLES
from .section import BoreTooWide

if TYPE_CHECKING:
    from .arm import SlenderArm

CRUSHED_FORCE_RATIO = 1 - 1e-14
"""An arm is refused as crushed if F divided by the crushing force is at least this. The limit is below 1
because unit conversion has rounding errors."""
LENGTH_TOLERANCE = 1e-9
"""A given length may differ from the sum of the segment lengths by this relative amount (rounding)."""
INCOMPRESSIBLE_POISSON = 0.5
"""Poisson's ratio of incompressible material, which a swelling section requires."""


class NotSlender(InputError):
    """The arm is too short, relative to its radius, for the drag formulas of slender bodies."""


def refuse_wrong_choices(arm: "SlenderArm") -> None:
    """Raises InputError for an invalid Poisson's ratio, drag name, law or section of the arm. A swelling
    section requires a Poisson's ratio of 0.5."""
    poisson: Any = arm.poisson
    # Python counts `True` as the number 1.
    is_number = isinstance(poisson, Real) and not isinstance(poisson, bool | np.bool_)
    if not is_number or not -1 < poisson <= INCOMPRESSIBLE_POISSON:
        raise InputError(f"poisson = {short_repr(poisson)} is not a number above -1 and up to 0.5")
    if not isinstance(arm.drag, str):
        raise InputError(
            f"drag = {short_repr(arm.drag)} is not a name; choose one of {', '.join(DRAG_ESTIMATE_NAMES)}"
        )
    if arm.drag == ALL_DRAG_ESTIMATES_NAME:
        raise InputError(
            f"drag = {arm.drag!r} is for sweeps over all estimates; for one arm choose one of "
            f"{', '.join(DRAG_ESTIMATE_NAMES)}; the report states the results for all estimates"
        )
    if arm.drag not in DRAG_ESTIMATE_NAMES:
        raise InputError(
            f"drag = {short_repr(arm.drag)} is not known; choose one of {', '.join(DRAG_ESTIMATE_NAMES)}"
        )
    allowed_by_name = (
        ("law", arm.law, "linear or neo_hookean"),
        ("section", arm.section, "fixed or swelling"),
    )
    for name, value, allowed in allowed_by_name:
        if not isinstance(value, str):
            raise InputError(f"{name} = {short_repr(value)} is not a text; write {allowed}")
    try:
        law_of(arm.law, arm.section)
    except ValueError as error:
        raise InputError(str(error)) from None
    # Only incompressibility tells how the area changes with the stretch.
    if arm.section == "swelling" and poisson != INCOMPRESSIBLE_POISSON:
        raise InputError(
            f"poisson = {poisson} contradicts section = swelling, which is for incompressible rubber; "
            f"poisson must be {INCOMPRESSIBLE_POISSON:g}, or section fixed"
        )


def refuse_wrong_combinations(arm: "SlenderArm") -> None:
    """Raises InputError unless the arm has a length, modulus, viscosity, one shape, and at most one load."""
    if arm.segments is not None:
        _refuse_wrong_segments(arm)
    else:
        for name in ("length", "young"):
            if getattr(arm, name) is None:
                raise InputError(f"{name} is missing; write it as in '{GIVEN_QUANTITIES[name].example}'")
        _refuse_sections(arm)
    for name, quantity in GIVEN_QUANTITIES.items():
        if quantity.is_required and getattr(arm, name) is None:
            raise InputError(f"{name} is missing; write it as in '{quantity.example}'")
    if arm.pressure is not None and arm.force is not None:
        raise InputError(
            f"{arm.quoted_quantity('pressure')} and {arm.quoted_quantity('force')} are both given; give one "
            "of them: the pressure on the tip's cross section, or the resulting force"
        )


def _refuse_sections(arm: "SlenderArm") -> None:
    """Raises InputError unless an arm without segments has exactly one cross-section, with valid radii;
    BoreTooWide if the bore is too wide."""
    width_and_height = (arm.width, arm.height)
    for name, reason in (
        ("inner_radius", "a rectangular section has no bore"),
        ("tip_radius", "only a cone has a tip radius"),
    ):
        if getattr(arm, name) is not None and arm.radius is None:
            raise InputError(f"{arm.quoted_quantity(name)} needs a radius; {reason}")
    # Both given, neither given, or one side of a rectangle only.
    if (arm.radius is None) == (width_and_height == (None, None)) or (
        arm.radius is None and None in width_and_height
    ):
        sizes = ("radius", "width", "height")
        given_sizes = " and ".join(name for name in sizes if getattr(arm, name) is not None) or "no size"
        raise InputError(
            f"radius: give either a radius, or width and height, or segments; the arm has {given_sizes}"
        )
    # A missing size is nan here, for which the comparison is false.
    if arm.si.inner_radius >= arm.si.radius:
        raise BoreTooWide(
            f"{arm.quoted_quantity('inner_radius')} is not below {arm.quoted_quantity('radius')}"
        )
    if arm.tip_radius is None:
        return
    if arm.inner_radius is not None:
        raise InputError(
            f"{arm.quoted_quantity('tip_radius')} and {arm.quoted_quantity('inner_radius')} are both given, "
            "but a cone is solid; give one of them, or segments"
        )
    if not MIN_TAPER <= arm.si.tip_radius / arm.si.radius <= MAX_TAPER:
        raise InputError(
            f"{arm.quoted_quantity('tip_radius')} is {arm.si.tip_radius / arm.si.radius:.3g} of the radius; "
            f"the ratio must be from {MIN_TAPER:g} to {MAX_TAPER:g}"
        )


def _refuse_wrong_segments(arm: "SlenderArm") -> None:
    """Raises InputError if an arm with segments also has a cross-section, or a length that is not the sum of
    the segment lengths. Also raises InputError for a segment that is too short, or if neither a segment nor
    the arm has a Young's modulus."""
    for name in (*SECTION_SIZE_NAMES[0], *SECTION_SIZE_NAMES[1]):
        if getattr(arm, name) is not None:
            raise InputError(
                f"{arm.quoted_quantity(name)} and segments are both given; give one of them, because every "
                "segment has its own radius"
            )
    segments = arm.si_segments
    total = sum(segment.length for segment in segments)
    for number, segment in enumerate(segments, 1):
        if segment.young is None and arm.young is None:
            raise InputError(
                f"segments, number {number}: young is missing; give young for this segment or for the arm"
            )
        # The profile of the arm would refuse such a row, with a message about u instead of segments.
        if segment.length < MIN_ROW_DISTANCE * total:
            raise InputError(
                f"segments, number {number}: the length is {segment.length / total:.2g} of the arm's length; "
                f"it must be at least {MIN_ROW_DISTANCE:g}, so make this segment longer or leave it out"
            )
    # Negated, so that nan is refused too.
    if arm.length is not None and not abs(arm.si.length - total) <= LENGTH_TOLERANCE * total:
        unit = unit_of(arm.length, "m")
        summed = f"{value_in_unit(total, unit, 'm'):.6g} {unit}"
        raise InputError(
            f"{arm.quoted_quantity('length')} is not the sum of the segment lengths, {summed}; "
            "leave out length"
        )


def refuse_out_of_range(arm: "SlenderArm") -> None:
    """Raises InputError for an arm without mass, and if its stiffnesses, its units or the fluid's inertia
    overflow or underflow. Raises NotSlender for an arm that is too short."""
    if arm.si.density_difference <= -arm.si.fluid_density:
        density_text = arm.quoted_quantity("density_difference")
        min_density = f"{-arm.si.fluid_density:.4g} kg/m^3"
        raise InputError(
            f"{density_text} gives the arm no positive mass; the difference must be above {min_density}"
        )
    length = "segments: their length" if arm.length is None else arm.quoted_quantity("length")
    try:
        slenderness = arm.geometry.length / arm.geometry.largest_drag_radius
        is_representable = all(0 < number < inf for number in (arm.k1, arm.k2, arm.force_scale))
        # The drags of too short an arm mean nothing, and are not always numbers.
        if slenderness >= MIN_FORMULA_SLENDERNESS:
            is_representable = is_representable and bool(arm.material)
    except (ArithmeticError, ValueError):
        is_representable = False
    if not is_representable:
        raise InputError(
            f"{length}, with this section and Young's modulus, makes stiffnesses or the unit of force "
            "overflow or underflow; check the units"
        )
    # Tested last, because a length or radius that overflows leaves no ratio to test.
    if slenderness < MIN_FORMULA_SLENDERNESS:
        raise NotSlender(
            f"{length} is {slenderness:.3g} radii, with {_radius_text(arm)}; the drag of a slender arm needs "
            f"at least {MIN_FORMULA_SLENDERNESS:g}, so give a longer or thinner arm"
        )
    if not _has_representable_motion(arm):
        raise InputError(
            f"{length} and {arm.quoted_quantity('viscosity')} make the unit of time or the inertia of the "
            "fluid overflow or underflow; check the units"
        )


def _has_representable_motion(arm: "SlenderArm") -> bool:
    """Whether the unit of time, and the inertia of the fluid relative to its viscosity, are representable as
    floating-point numbers."""
    try:
        tau2 = min(arm.tau2_with(drag) for drag in arm.base_drag_estimates)
        inertia = arm.si.fluid_density * arm.si.length**2 / (arm.si.viscosity * tau2)
        # The square leaves room for the frequency in units of 1/tau2.
        return 0 < tau2 < inf and inertia**2 < inf
    except ArithmeticError:
        return False


def _radius_text(arm: "SlenderArm") -> str:
    """The largest radius of the arm for messages: as given by the user, or else as a number in m."""
    if arm.radius is None:
        adjective = "largest" if arm.segments else "equivalent"
        return (
            f"{'a' if arm.segments else 'an'} {adjective} radius of {arm.geometry.largest_drag_radius:.3g} m"
        )
    is_wider_at_tip = arm.tip_radius is not None and arm.si.tip_radius > arm.si.radius
    return arm.quoted_quantity("tip_radius" if is_wider_at_tip else "radius")


def refuse_crushed(arm: "SlenderArm") -> None:
    """Raises InputError if the load crushes the arm at its weakest cross-section. An arm without load, or
    with a load given relative to flutter, is not checked."""
    load = arm.load_name
    # A load relative to flutter has no value before flutter is solved.
    if load is None or arm.load_over_flutter is not None or CRUSHED_FORCE_RATIO * arm.crushing_force > arm.F:
        return
    limit = arm.crushing_force * arm.load_scale
    si_unit = UNITS_AND_EXAMPLES[load][0]
    unit = unit_of(getattr(arm, load), si_unit)
    phrase = "the weakest section of" if arm.geometry.varies_along_arm else ""
    raise InputError(
        f"{arm.quoted_quantity(load)} crushes {f'{phrase} the arm'.strip()}; the load on a linear material "
        f"must be below {float(f'{value_in_unit(limit, unit, si_unit):.4g}'):g} {unit}"
    )
