"""Parameters changed by the quantities of an arm, and the axes of a sweep's grid.

An axis of the load is an axis of F, an axis of Poisson's ratio is an axis of k2, and a grid of both is still
a grid of parameters. Any other quantity changes several parameters at once, or none. With an axis of such a
quantity, or with a load relative to flutter, the points form a grid over the arm's quantities, and every
parameter has its own value at every point. A phase diagram always needs a grid of parameters, in which the
values of drag are an axis of gamma3.
"""

from collections.abc import Mapping

from ...errors import InputError
from ...model.arm.quantities import LOADS, RELATIVE
from ...model.arm.refusals import NotSlender
from ...model.arm.section import NoWall
from ...model.parameters import PARAMETERS

LOAD_AXES = (*LOADS, *RELATIVE)
"""Config keys of the load, absolute or relative to flutter. An arm has at most one of them."""
AXIS_OF = dict.fromkeys(LOADS, "F") | {"poisson": "k2"}
"""Parameter that a quantity changes, by name of every quantity that changes exactly one parameter."""
CHANGED_PARAMETER = AXIS_OF | dict.fromkeys(RELATIVE, "F")
"""Parameter that an axis changes in a grid over an arm's quantities, by name of the axis, where there is only
one."""
STORED_ALONG = AXIS_OF | {"drag": "gamma3", "tau2": "gamma3"}
"""The parameter along whose axis a quantity or unit with several values is stored."""
FLUID = ("viscosity", "fluid_density", "density_difference")
"""Quantities that change no parameter: times are proportional to the viscosity, and the densities decide
whether the model applies."""
ALL_BUT_LOAD = (
    "length",
    "young",
    "radius",
    "inner_radius",
    "tip_radius",
    "width",
    "height",
    "poisson",
    *FLUID,
    "drag",
)
"""All quantities of an arm except the load."""
SLENDER, NOT_SLENDER, CRUSHED, NO_WALL, NO_FLUTTER, FLUTTER_UNKNOWN = 0, 100, 101, 102, 103, 104
"""Codes of a point of an arm: the rod model applies; arm too short for the drag of slender bodies; F reaches
k1; bore as wide as the arm; load relative to a flutter threshold that does not exist, or that the search does
not find. All but SLENDER are statuses, numbered above the statuses of every task."""
MOST_POINTS = 1_000_000
"""Maximum number of points of a grid over an arm's quantities, since the parameters of all points are held in
memory."""


def names_over(sizes: Mapping[str, int], in_diagram: bool) -> tuple[str, ...]:
    """Axes of a grid over an arm's quantities; empty if the points form a grid of parameters.

    sizes: number of values of each given quantity, and of each parameter beside the arm. in_diagram: whether
    the points are the rows of a phase diagram.
    """
    given = (name for name in (*ALL_BUT_LOAD, *LOAD_AXES) if name in sizes)
    quantities = [name for name in given if sizes[name] > 1 or name in RELATIVE]
    if all(name in (STORED_ALONG if in_diagram else AXIS_OF) for name in quantities):
        return ()
    return (*quantities, *(name for name in PARAMETERS if sizes.get(name, 1) > 1))


def parameter_of_axis(axis: str) -> str:
    """Parameter that an axis of a grid over an arm's quantities changes; "" for several or no parameter."""
    return axis if axis in PARAMETERS else CHANGED_PARAMETER.get(axis, "")


STATUS_OF_ERROR = {NotSlender: NOT_SLENDER, NoWall: NO_WALL}
"""Status of a point by class of the error that its arm raises."""


class UncoveredArm(ValueError):
    """The rod model does not apply to this arm; `status` is the status of the arm's points."""

    def __init__(self, error: InputError):
        super().__init__(f"parameters.arm.{error}")
        self.status = STATUS_OF_ERROR[type(error)]
