"""Rows of the table in a report on an arm: numbers with formulas and sources, and phrases for materials."""

from math import isfinite
from typing import NamedTuple

from ..model.arm.arm import SlenderArm
from ..model.arm.geometry import Station
from ..model.arm.section import Tube
from ..model.material.laws import LINEAR_CONSTITUTIVE_LAW
from ..model.units import with_si_prefix
from .load_texts import three_digit_range_text
from .planes import PlaneOfMotion

RUBBER_STRESS_FORMULA = "stress E (h - 1/h^2)/3 at the stretch h, incompressible"
"""Formula of the stress in neo-Hookean rubber, for the table."""


class NumberRow(NamedTuple):
    """Row of the table: name, value, formula and source of one number of an arm."""

    name: str
    value: str
    formula: str
    source: str


def number_rows(plane: PlaneOfMotion) -> list[NumberRow]:
    """Rows with all numbers of an arm, dimensional numbers first. plane: plane of the first flutter."""
    arm = plane.arm
    return [
        *plane_rows(plane),
        *taper_segments_and_law_rows(arm),
        *dimensional_rows(arm),
        *flutter_force_row(plane),
        *drag_rows(arm),
        *dimensionless_rows(arm),
    ]


def plane_rows(plane: PlaneOfMotion) -> list[NumberRow]:
    """Row with the plane of motion and the width w and height h of a rectangular section, h in this plane; an
    empty list for other sections."""
    if not plane.name:
        return []
    sizes = f"w = {plane.arm.si.width:.4g} m, h = {plane.arm.si.height:.4g} m"
    return [NumberRow("motion", f"in {plane.name}", sizes, "where the arm flutters first")]


def taper_segments_and_law_rows(arm: SlenderArm) -> list[NumberRow]:
    """Rows with the taper or the segments, and with the constitutive law if it is not linear; an empty list
    for a uniform arm of linear material."""
    rows = []
    if arm.taper != 1:
        formula = "tip radius/radius; all other rows are for the base"
        rows.append(NumberRow("taper", f"{arm.taper:.4g}", formula, "k1, k2, gamma3 ~ r^2, k3 ~ r^4"))
    elif arm.geometry.varies_along_arm:
        start = 0.0
        for number, station in enumerate(arm.geometry.stations, 1):
            interval_text = f"u = {start:.4g} to {station.end_position:.4g}"
            source = "all other rows are for segment 1" if number == 1 else "drag by its own radius"
            rows.append(
                NumberRow(
                    f"segment {number}", interval_text, station_radii_and_modulus_phrase(station), source
                )
            )
            start = station.end_position
    if arm.law != LINEAR_CONSTITUTIVE_LAW.law_name:
        rows.append(
            NumberRow(
                "law",
                f"neo-Hookean, {arm.section} section",
                RUBBER_STRESS_FORMULA,
                "E is the modulus at small strain",
            )
        )
    return rows


def dimensional_rows(arm: SlenderArm) -> list[NumberRow]:
    """Rows with cross-section, stiffness and load of an arm, in SI units."""
    section = arm.cross_section
    kappa = section.shear_coefficient(arm.poisson)
    return [
        NumberRow("A", f"{section.area:.4g} m^2", section.area_and_moment_formula.split(", ")[0], "geometry"),
        NumberRow(
            "I",
            f"{section.second_moment:.4g} m^4",
            section.area_and_moment_formula.split(", ")[1],
            "geometry",
        ),
        NumberRow("kappa", f"{kappa:.4g}", section.shear_coefficient_formula, "Cowper 1966"),
        NumberRow("k3", f"{arm.bending_stiffness:.4g} N m^2", "E I", "paper, Sec. III"),
        NumberRow("k3/L^2", f"{arm.force_scale:.4g} N", "unit of force", "paper, Sec. VI"),
        *load_row(arm),
    ]


def load_row(arm: SlenderArm) -> list[NumberRow]:
    """Row with the tip force; an empty list for an arm without load."""
    if arm.load_name is None:
        return []
    tip_clause = " of the tip" if arm.geometry.varies_along_arm else ""
    formula = "as given"
    if arm.load_name == "pressure":
        formula = f"{arm.geometry.tip.section.pressure_force_formula}{tip_clause}"
    return [NumberRow("tip force", f"{arm.tip_force:.4g} N", formula, "paper, Sec. IV")]


def flutter_force_row(plane: PlaneOfMotion) -> list[NumberRow]:
    """Row with the force at the tip at which the arm flutters; an empty list if the arm does not flutter for
    one or more of the drags, or if a search failed. The force is stated because, of two arms with tips of
    different size, the arm with the larger flutter pressure may have the smaller flutter force."""
    thresholds = plane.thresholds
    forces = [] if thresholds.failure_texts else plane.flutter_load_by_drag
    # A range over drags that leaves some drags out would look like the whole range.
    if not forces or not all(isfinite(force) for force in forces):
        return []
    value = value_with_drag_range(forces, " N")
    return [NumberRow("flutter force", value, "F at flutter times k3/L^2", "paper, Sec. IV, VI")]


def value_with_drag_range(values: list[float], unit: str = "") -> str:
    """values[0], followed by the range of all values in brackets and by `unit`, as text. values: a quantity
    for each drag, the most likely drag first."""
    return f"{values[0]:.3g} ({three_digit_range_text(min(values), max(values))}){unit}"


def drag_rows(arm: SlenderArm) -> list[NumberRow]:
    """Rows with the drag coefficients and the time scale tau2, with their ranges over the drags."""
    drags = arm.base_drag_estimates
    translation = "Cox 1970; Gray & Hancock 1955, Lighthill 1976"
    return [
        NumberRow(
            "drag across",
            value_with_drag_range([d.gamma2 for d in drags], " Pa s"),
            "4 pi eta/(ln(2 L/a) - 1/2)",
            translation,
        ),
        NumberRow(
            "axial drag",
            value_with_drag_range([d.gamma1 for d in drags], " Pa s"),
            "2 pi eta/(ln(2 L/a) - 3/2)",
            translation,
        ),
        NumberRow(
            "rotational drag",
            value_with_drag_range([d.gamma3 for d in drags], " Pa s m^2"),
            "(pi to 4 pi) eta a^2",
            "section turning about a diameter; Powers 2010",
        ),
        NumberRow(
            "tau2",
            value_with_drag_range([arm.tau2_with(d) for d in drags], " s"),
            "drag across L^4/k3",
            "paper, Sec. VI",
        ),
    ]


def dimensionless_rows(arm: SlenderArm) -> list[NumberRow]:
    """Rows with the dimensionless parameters of an arm, named like keys of a config; F only with a load."""
    drags = arm.base_drag_estimates
    force = (
        NumberRow("F", f"{arm.F:.5g}", "tip force L^2/k3", "paper, Sec. IV, VI") if arm.load_name else None
    )
    return [
        NumberRow("k1", f"{arm.k1:.5g}", "E A L^2/k3", "paper, Sec. III, VI"),
        NumberRow("k2", f"{arm.k2:.5g}", "kappa G A L^2/k3, G = E/(2 (1 + nu))", "paper, Sec. III, VI"),
        NumberRow(
            "gamma3",
            value_with_drag_range([arm.gamma3_with(d) for d in drags]),
            "rotational drag/(drag across L^2)",
            "paper, Sec. VI",
        ),
        NumberRow(
            "gamma1",
            value_with_drag_range([d.gamma1 / d.gamma2 for d in drags]),
            "axial drag/drag across",
            "paper, Sec. VI",
        ),
        *([force] if force else []),
    ]


def station_radii_and_modulus_phrase(station: Station) -> str:
    """Phrase for the radius, the inner radius (of a tube) and Young's modulus of a segment: "radius 6 mm,
    inner radius 3 mm, 80 kPa"."""
    sizes = {"radius": station.section.drag_radius}
    if isinstance(station.section, Tube):
        sizes["inner radius"] = station.section.inner_radius
    texts = [f"{name} {_with_si_prefix(value, 'm')}" for name, value in sizes.items()]
    return ", ".join([*texts, _with_si_prefix(station.young, "Pa")])


def _with_si_prefix(value: float, si_unit: str) -> str:
    """A value in the SI unit `si_unit` as text with four digits and a prefix: "6 mm"."""
    factor, unit = with_si_prefix(value, si_unit)
    return f"{value * factor:.4g} {unit}"
