"""Parameters of the rod that each quantity of an arm changes, and the axes of a sweep's grid.

An axis of the load is an axis of F, an axis of Poisson's ratio is an axis of k2, and a grid of both is still
a grid of parameters. Any other quantity changes several parameters at once, or no parameter. With an axis of
such a quantity, or with a load relative to flutter, the points form a grid over the arm's quantities, and the
parameters are computed point by point. A phase diagram always needs a grid of parameters, in which the drag
estimates are the values of an axis of gamma3.
"""

from collections.abc import Mapping
from itertools import chain

from ...model.arm.quantities import LOAD_NAME_BY_RELATIVE_LOAD, LOAD_NAMES, SECTION_SIZE_NAMES
from ...model.parameters import PARAMETERS

LOAD_KEYS = (*LOAD_NAMES, *LOAD_NAME_BY_RELATIVE_LOAD)
"""Names of the config keys for the load, absolute or relative to flutter. An arm has at most one load."""
SINGLE_PARAMETER_OF = dict.fromkeys(LOAD_NAMES, "F") | {"poisson": "k2"}
"""Name of the only parameter that depends on a quantity of the arm, by name of the quantity. Quantities on
which several parameters depend are not included."""
PARAMETER_CHANGED_ALONG = SINGLE_PARAMETER_OF | dict.fromkeys(LOAD_NAME_BY_RELATIVE_LOAD, "F")
"""Name of the parameter that changes along an axis of a grid over an arm's quantities, by name of the
axis."""
FILE_AXIS_OF_QUANTITY = SINGLE_PARAMETER_OF | {"drag": "gamma3", "tau2": "gamma3"}
"""For each quantity or unit of the arm, by name: the rod parameter with which it varies. If the file contains
several values of the quantity or unit, they are stored along the axis of this parameter."""
FLUID_QUANTITIES = ("viscosity", "fluid_density", "density_difference")
"""Names of the quantities of the fluid, which change no parameter of the rod: times are proportional to the
viscosity, and the densities are used only to test whether the model applies."""
NON_LOAD_KEYS = ("length", "young", *chain(*SECTION_SIZE_NAMES), "poisson", *FLUID_QUANTITIES, "drag")
"""Names of all quantities of an arm except the load."""
MAX_ARM_GRID_POINTS = 1_000_000
"""Maximum number of points of a grid over an arm's quantities; larger grids are refused, because the
parameters of all points are kept in memory."""


def grid_axis_names(sizes: Mapping[str, int], in_diagram: bool) -> tuple[str, ...]:
    """Names of the axes of a grid over an arm's quantities; empty if the points form a grid of parameters.

    sizes: number of values of each given quantity, and of each parameter that replaces the arm's value.
    in_diagram: whether the grid is a phase diagram, in which several drags make an axis of gamma3.
    """
    names = (name for name in (*NON_LOAD_KEYS, *LOAD_KEYS) if name in sizes)
    quantities = [name for name in names if sizes[name] > 1 or name in LOAD_NAME_BY_RELATIVE_LOAD]
    if all(name in (FILE_AXIS_OF_QUANTITY if in_diagram else SINGLE_PARAMETER_OF) for name in quantities):
        return ()
    return (*quantities, *(name for name in PARAMETERS if sizes.get(name, 1) > 1))


def parameter_of_axis(axis: str) -> str:
    """Name of the only parameter that changes along an axis of an arm's grid; "" if several parameters or no
    parameter change."""
    return axis if axis in PARAMETERS else PARAMETER_CHANGED_ALONG.get(axis, "")
