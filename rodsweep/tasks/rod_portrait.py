"""Everything about one rod, for its portrait: thresholds, criticality, branches, modes, three cycles."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..config.document.reading import validated, yaml_of
from ..config.tasks import CONFIGS
from ..errors import InputError
from ..model.parameters import OPTIONAL_PARAMETERS
from ..post.branch_curves import Range, curves_of, union
from ..post.rod_portrait.results import RodResults
from ..results.file.view import View
from ..results.layouts.thresholds import CROSSING_KINDS
from .running.in_memory import solved_view
from .running.job import Job, job_of

PLACES = (0.1, 0.5, 0.9)
"""Forces of the three cycles, as fractions of the length of all ranges with a stable cycle."""
SHAPES = 12
"""Times per period at which a shape is solved; more cannot be told apart in a small panel."""
MODE_KINDS = ("onset", "hopf")
"""Kinds of thresholds at whose first place the leading mode is solved."""
F_MAX = 200.0
"""Default of the largest force, as of the task thresholds."""

Solve = Callable[[Job], View]


@dataclass(frozen=True, slots=True, kw_only=True)
class PortraitRequest:
    """A rod and the choices of its portrait.

    parameters: values by name. F_max: largest force. accuracy: relative error, or None for the default of
    each task. material: section `material` of a config, empty for a uniform rod of linear material.
    """

    parameters: Mapping[str, float]
    F_max: float = F_MAX
    accuracy: float | None = None
    material: Mapping[str, Any] = field(default_factory=dict)

    def job(self, task: str, options: Mapping[str, Any], forces: Sequence[float] = ()) -> Job:
        """Job of a task for this rod, at some forces if the task takes them."""
        names = (*CONFIGS[task].taken_of_a_rod(options), *OPTIONAL_PARAMETERS)
        values: dict[str, Any] = {n: self.parameters[n] for n in names if n in self.parameters and n != "F"}
        if forces:
            values["F"] = list(forces)
        tree: dict[str, Any] = {"task": task, "parameters": values, task: dict(options)}
        tree |= {"material": dict(self.material)} if self.material else {}
        tree |= {} if self.accuracy is None else {"accuracy": self.accuracy}
        return job_of(Path(task), validated(tree), yaml_of(tree))


def rod_results(request: PortraitRequest, solve: Solve = solved_view) -> RodResults:
    """Solves everything about a rod; solve: how the points of a job are solved.

    Raises InputError for parameters that are no rod. What cannot be solved of a rod has its reason in the
    result.
    """
    F_max = {"F_max": request.F_max}
    views = {"thresholds": solve(request.job("thresholds", F_max))}
    missing: dict[str, str] = {}

    def add(task: str, options: Mapping[str, Any], forces: Sequence[float] = ()) -> None:
        try:
            views[task] = solve(request.job(task, options, forces))
        except InputError as error:
            missing[task] = str(error)

    add("criticality", F_max)
    add("branch", {"start": 0.0, "stop": request.F_max})
    modes = mode_forces(views["thresholds"])
    if modes:
        add("modes", {}, sorted(set(modes.values())))
    else:
        missing["modes"] = f"no threshold up to F = {request.F_max:g}"
    ranges = stable_ranges(views["branch"]) if "branch" in views else []
    if ranges:
        add("limit_cycle", {"start": "hopf", "shapes": SHAPES}, cycle_forces(ranges))
    else:
        missing["limit_cycle"] = missing.get("branch", "no stable cycle on a branch from a Hopf point")
    return RodResults(
        parameters=request.parameters, F_max=request.F_max, views=views, mode_forces=modes, missing=missing
    )


def mode_forces(thresholds: View) -> dict[str, float]:
    """Force of the first threshold of each kind at which the leading mode is drawn, by kind."""
    kinds, forces = (thresholds.by_point(f"crossing_{name}")[0] for name in ("kind", "F"))
    found = {}
    for kind in MODE_KINDS:
        places = np.flatnonzero(kinds == CROSSING_KINDS.index(kind))
        if len(places):
            found[kind] = float(forces[places[0]])
    return found


def stable_ranges(branch: View) -> list[Range]:
    """Ranges of the force with a stable cycle on a branch."""
    return union(piece for curve in curves_of(branch, 0) for piece in curve.stable_ranges)


def cycle_forces(ranges: Sequence[Range]) -> list[float]:
    """Forces of the three cycles, increasing, spread evenly over ranges of the force with a stable cycle."""
    lengths = np.array([high - low for low, high in ranges])
    before = np.concatenate([[0.0], np.cumsum(lengths)])
    forces = []
    for place in PLACES:
        along = place * before[-1]
        number = min(int(np.searchsorted(before, along, side="right")) - 1, len(ranges) - 1)
        forces.append(float(ranges[number][0] + along - before[number]))
    return forces
