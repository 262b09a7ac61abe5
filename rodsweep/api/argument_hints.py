"""Advice on arguments that `rs.Arm` and `rs.Rod` do not have, but other objects or tasks do."""

from ..model.arm.quantities import GIVEN_QUANTITIES
from ..model.parameters import PARAMETERS
from .task_keywords import KEYWORDS_OF_TASK

UNKNOWN_ARM_ARGUMENT_HINTS = {
    "load_kind": "the load is given as pressure or force; an arm without load answers in Pa, and "
    'rs.sweep(task, arm={..., "load_kind": "force"}) in newton',
    "taper": "a cone has tip_radius",
    "profile": "an arm of several materials has segments; factors along an arm are given to "
    "rs.Rod(arm=arm, profile=...)",
    "F": "the load of an arm is pressure or force",
}
"""Advice on arguments that `rs.Arm` does not have, by name."""
UNKNOWN_ROD_ARGUMENT_HINTS = {
    "k3": "k3 is the unit of stiffness",
    "gamma2": "gamma2 is the unit of drag; a rod has gamma1 and gamma3",
}
"""Advice on arguments that `rs.Rod` does not have, by name."""


def unknown_arm_argument_hint(name: str) -> str:
    """Advice on the argument `name` that `rs.Arm` does not have; empty if nothing is known about it."""
    if name in UNKNOWN_ARM_ARGUMENT_HINTS:
        return UNKNOWN_ARM_ARGUMENT_HINTS[name]
    if name in PARAMETERS:
        return f"{name} follows from the quantities of the arm; rs.Rod(arm=arm, {name}=...) replaces it"
    return _methods_with_option_hint(name, "arm")


def rod_argument_hint(name: str) -> str:
    """Advice on the argument `name` that `rs.Rod` does not have; empty if nothing is known about it."""
    if name in UNKNOWN_ROD_ARGUMENT_HINTS:
        return UNKNOWN_ROD_ARGUMENT_HINTS[name]
    if name in GIVEN_QUANTITIES or name == "segments":
        return f"{name} belongs to an arm: rs.Rod(arm=rs.Arm({name}=..., ...))"
    return _methods_with_option_hint(name, "rod")


def _methods_with_option_hint(name: str, owner: str) -> str:
    """Advice on an option of tasks: the methods of `owner` that take it; empty if `name` is no option."""
    tasks = [task for task, options in KEYWORDS_OF_TASK.items() if name in options.__annotations__]
    return f"{name} is an option of tasks, as in {owner}.{tasks[0]}({name}=...)" if tasks else ""
