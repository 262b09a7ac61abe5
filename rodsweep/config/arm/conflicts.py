"""Keys of an arm in a config that exclude each other, or do not suit the task."""

from collections.abc import Collection
from typing import TYPE_CHECKING

from .axes import LOAD_KEYS

if TYPE_CHECKING:
    from .section import ArmConfig


def refuse_conflicting_keys(arm: "ArmConfig", needs_force: bool, given_parameters: Collection[str]) -> None:
    """Raises ValueError if the load does not suit the task, or if k2 is given in addition to an axis of
    Poisson's ratio.

    given_parameters: names of the parameters that replace the arm's values.
    """
    loads = ["parameters.F"] if "F" in given_parameters else []
    loads += [f"parameters.arm.{name}" for name in LOAD_KEYS if getattr(arm, name) is not None]
    if loads[1:]:
        raise ValueError(f"{loads[0]} and {loads[1]} are both given; give one of them")
    if "poisson" in arm.varying_quantities and "k2" in given_parameters:
        raise ValueError(
            "parameters.arm.poisson has several values but changes only k2, and parameters.k2 is given "
            "too; give one of them"
        )
    if arm.load and not needs_force:
        unit_clause = "load_kind: force gives the loads in newton, and " if arm.load == "force" else ""
        raise ValueError(
            f"parameters.arm.{arm.load} is given, but the task solves for the load; remove it; {unit_clause}"
            "F_max sets the end of the search (for the task branch, branch.stop)"
        )
    if arm.load and arm.load_kind:
        raise ValueError(
            f"parameters.arm.load_kind is given, but parameters.arm.{arm.load} is given too; remove load_kind"
        )
    if needs_force and not (arm.load or "F" in given_parameters):
        if arm.load_kind:
            raise ValueError(
                f"parameters.arm.load_kind is given, but the task needs a load; give parameters.arm."
                f"{arm.load_kind} instead"
            )
        raise ValueError("parameters.arm.pressure is missing; give the pressure on the tip or a force")
