"""What the quantities of an arm move as axes, and which of them make the grid of a sweep.

An axis of the load is one of F, an axis of Poisson's ratio one of k2, and a grid of both stays a grid of
parameters. Any other quantity moves several parameters at once, or none: with an axis of these, or a load
relative to flutter, the points are a grid over the arm's own quantities, on which every parameter has its own
value. A phase diagram needs parameters: there, the drags are an axis of gamma3.
"""

from collections.abc import Mapping

from ...model.arm.quantities import LOADS, RELATIVE
from ...model.parameters import NONLINEAR_PARAMETERS

LOAD_AXES = (*LOADS, *RELATIVE)
"""What may say the load; an arm has one of them or none."""
AXIS_OF = dict.fromkeys(LOADS, "F") | {"poisson": "k2"}
"""The one parameter that a quantity moves, where it moves one only."""
MOVES = AXIS_OF | dict.fromkeys(RELATIVE, "F")
"""The same along the axes of a grid over an arm's quantities."""
ALONG = AXIS_OF | {"drag": "gamma3", "tau2": "gamma3"}
"""Along which parameter of a grid of parameters a quantity or a unit lies, where it has several values."""
FLUID = ("viscosity", "fluid_density", "density_difference")
"""What moves no parameter: units of time are proportional to viscosity, densities say whether the model
applies."""
SECTION = ("length", "young", "radius", "inner_radius", "width", "height", "poisson", *FLUID, "drag")
"""What makes an arm beside its load."""
SLENDER, NOT_SLENDER, CRUSHED, NO_WALL, NO_FLUTTER = 0, 100, 101, 102, 103
"""Whether a rod covers a point: it does; the arm is too short for the drag of slender bodies; F reaches k1;
the bore is as wide as the arm; the load is relative to a flutter that there is not. All but the first are
statuses, which no task's own statuses reach."""
MOST_POINTS = 1_000_000
"""Points of a grid over an arm's quantities, whose parameters are all in memory."""


def names_over(sizes: Mapping[str, int], in_diagram: bool) -> tuple[str, ...]:
    """The axes of a grid over an arm's quantities; none where the points are a grid of parameters.

    sizes: how many values each quantity that is given, and each parameter beside the arm, has. in_diagram:
    whether they make the rows of a phase diagram.
    """
    given = (name for name in (*SECTION, *LOAD_AXES) if name in sizes)
    quantities = [name for name in given if sizes[name] > 1 or name in RELATIVE]
    if all(name in (ALONG if in_diagram else AXIS_OF) for name in quantities):
        return ()
    return (*quantities, *(name for name in NONLINEAR_PARAMETERS if sizes.get(name, 1) > 1))


def moved_by(axis: str) -> str:
    """The one parameter that an axis of an arm's grid moves; empty where it moves several or none."""
    return axis if axis in NONLINEAR_PARAMETERS else MOVES.get(axis, "")
