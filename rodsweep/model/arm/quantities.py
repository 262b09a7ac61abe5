"""The quantities of an arm: one table of units, meanings and examples, and lists made from the table.

Configs, files, figures and the command line take units and meanings from this module, which uses no arm and
no formula.
"""

from collections.abc import Collection
from typing import NamedTuple

from ...errors import InputError
from ..units import GivenQuantity, load_over_flutter, quantity_in_si

LOAD_NAMES = ("pressure", "force")
"""Names of the loads on the tip; an arm has at most one load."""


class Quantity(NamedTuple):
    """A quantity of an arm: SI unit, meaning, and an example with a unit (empty text for a pure
    number)."""

    unit: str
    meaning: str
    example: str = ""
    is_required: bool = False
    """Whether the user must give the quantity for every arm."""
    may_be_nonpositive: bool = False
    """Whether zero and negative values of the quantity are allowed."""


GIVEN_QUANTITIES = {
    "length": Quantity("m", "length of the arm", "10 cm"),
    "radius": Quantity("m", "radius of the arm's circular section", "5 mm"),
    "inner_radius": Quantity("m", "radius of the bore of the arm, closed at its tip", "3 mm"),
    "tip_radius": Quantity(
        "m", "radius at the tip of a solid cone; radius is then the radius at the base", "3 mm"
    ),
    "width": Quantity("m", "width of the arm's section, across the plane of motion", "10 mm"),
    "height": Quantity("m", "height of the arm's section, in the plane of motion", "8 mm"),
    "young": Quantity("Pa", "Young's modulus of the arm at small strain", "100 kPa"),
    "viscosity": Quantity("Pa*s", "viscosity of the fluid", "1.4 Pa s", is_required=True),
    "pressure": Quantity("Pa", "pressure on the tip's cross section", "2 kPa", may_be_nonpositive=True),
    "force": Quantity("N", "follower force at the tip", "0.16 N", may_be_nonpositive=True),
    "fluid_density": Quantity("kg/m^3", "density of the fluid", "1260 kg/m^3"),
    "density_difference": Quantity(
        "kg/m^3", "density of the arm minus density of the fluid", "-160 kg/m^3", may_be_nonpositive=True
    ),
    "poisson": Quantity("1", "Poisson's ratio of the arm"),
    "drag": Quantity("1", "drag estimate, by name"),
    **{
        f"{load}_over_flutter": Quantity(
            "1", f"{load} divided by the {load} at first flutter, with the likeliest drag"
        )
        for load in LOAD_NAMES
    },
}
"""All quantities of an arm that a user may give, by name."""
UNITS_AND_EXAMPLES = {
    name: (quantity.unit, quantity.example) for name, quantity in GIVEN_QUANTITIES.items() if quantity.example
}
"""(SI unit, example) of each quantity with a unit, by name."""
LOAD_NAME_BY_RELATIVE_LOAD = {f"{load}_over_flutter": load for load in LOAD_NAMES}
"""Name of the load, "pressure" or "force", by name of the relative load: the load divided by the load at
first flutter with the likeliest drag."""
SECTION_SIZE_NAMES = ("radius", "inner_radius", "tip_radius"), ("width", "height")
"""(names of the quantities of a circular section, names of the quantities of a rectangular section)."""
ARM_SCALES = {
    "tau2": Quantity("s", "unit of time, gamma2 L^4/k3"),
    "force_scale": Quantity("N", "unit of force, k3/L^2"),
    "pressure_scale": Quantity("Pa", "pressure on the tip's cross section that makes F = 1, k3/(L^2 A)"),
}
"""Units of time, force and pressure that an arm defines, by name of the property of `SlenderArm`."""
LOAD_SCALE_NAME_BY_LOAD = {load: f"{load}_scale" for load in LOAD_NAMES}
"""Name of the property of `SlenderArm` that is the load at which F = 1, by name of the load."""
ARM_FILE_VARIABLES = GIVEN_QUANTITIES | ARM_SCALES
"""All variables of an arm in a result file, except the parameters of the arm as a rod."""


def arm_quantity_in_si(name: str, quantity: GivenQuantity | None) -> float:
    """Value in SI of the quantity `name` in UNITS_AND_EXAMPLES; nan for a missing quantity and for a load
    relative to flutter. Raises InputError, naming the quantity, for an invalid value."""
    if quantity is None or (name in LOAD_NAMES and load_over_flutter(quantity) is not None):
        return float("nan")
    value = quantity_in_si(name, quantity, *UNITS_AND_EXAMPLES[name])
    if not (GIVEN_QUANTITIES[name].may_be_nonpositive or value > 0):
        advice = "; leave it out for a solid arm" if name == "inner_radius" and value == 0 else ""
        raise InputError(f"{quoted_quantity(name, quantity)} is not above 0{advice}")
    return value


def quoted_quantity(name: str, quantity: GivenQuantity) -> str:
    """Name and value of the quantity `name` in UNITS_AND_EXAMPLES, for messages, like "length = '10 cm'". A
    text is quoted as the user wrote it; a number has its SI unit."""
    if isinstance(quantity, str):
        return f"{name} = '{quantity}'"
    unit, example = UNITS_AND_EXAMPLES[name]
    return f"{name} = {quantity_in_si(name, quantity, unit, example):.6g} {unit}"


def radius_name_of_diameter(name: str, names: Collection[str]) -> str:
    """The quantity in `names` that is half of the diameter `name`, such as inner_radius for inner_diameter;
    "" if `name` is no diameter, or if `names` lacks the radius."""
    plain_name = name.lower().replace("-", "_").removeprefix("outer_")
    radius = plain_name.replace("diameter", "radius")
    return radius if radius != plain_name and radius in names else ""
