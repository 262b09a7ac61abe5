"""Equilibrium of the arm whose tip the user drags, and motion of the arm after the release."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...api.arm import Arm
from ...errors import InputError
from ...post.figures.cycle.animation import FilmedMotion, motion_film
from ...post.rod_portrait.results import DescribedRod
from ...tasks.released_motion import FRAMES_PER_RETURN, ReleasedMotion, released_motion, shape_with_held_tip
from ...tasks.rod_portrait import PortraitRequest
from ...tasks.running.job import Job
from ..page_state import MATERIAL_SECTION_BY_LAW, PageState, dimensionless_parameters_of
from ..slider_scales import length_axis

TipPosition = tuple[float, float]
"""Coordinates (x, y) of the tip, in units of the arm's length L."""


def equilibrium_with_held_tip(state: PageState, tip: TipPosition | None) -> dict[str, Any]:
    """Equilibrium shape of the arm with its tip held at `tip`: coordinates `x` and `y`, (nodes,), in L. tip:
    None for the straight arm."""
    x, y = shape_with_held_tip(_limit_cycle_job(state), tip)
    return {"x": x, "y": y}


def released_motion_answer(state: PageState, tip: TipPosition) -> dict[str, Any]:
    """Motion of the arm after its tip is released at `tip`: fields of `ReleasedMotion`, and the variables
    below.

    tip: the argument `tip`. frames: number of shapes per return of the tip. period: period, in tau2, of the
    cycle that the arm reaches; NaN if the arm reaches no cycle. shape_x, shape_y: shapes over this period, in
    L, (shapes, nodes), with shapes = 0 if there is no cycle. Raises InputError if the motion cannot be
    integrated.
    """
    motion = released_motion(_limit_cycle_job(state, shapes=48), tip)
    if motion is None:
        raise InputError("the motion could not be integrated; release the tip at another point")
    page_values = {"tip": tip, "frames": FRAMES_PER_RETURN, "period": float(motion.cycle["period"])}
    return vars(motion) | _film_shapes(motion) | page_values


def motion_film_answer(state: PageState, tip: TipPosition) -> dict[str, Any]:
    """Film of the motion after the release of the tip at `tip`: the content of a GIF file, under the name
    `gif`."""
    return {"gif": motion_film(motion_in_page_units(state, released_motion_answer(state, tip)))}


def motion_in_page_units(state: PageState, answer: Mapping[str, Any]) -> FilmedMotion:
    """The motion after a release, in the units of the page. answer: result of `released_motion_answer`."""
    rod_or_arm = state.rod_or_arm()
    length = length_axis(state)
    tau2, time = (rod_or_arm.tau2, "s") if isinstance(rod_or_arm, Arm) else (1.0, "tau2")
    return FilmedMotion(
        x=answer["x"] * length.factor_from_dimensionless,
        y=answer["y"] * length.factor_from_dimensionless,
        shape_interval=answer["shape_interval"] * tau2,
        length=length.factor_from_dimensionless,
        units=(length.label, time),
    )


def _film_shapes(motion: ReleasedMotion) -> dict[str, Any]:
    x, y = (np.asarray(motion.cycle[name]) for name in ("shape_x", "shape_y"))
    has_cycle = x.ndim == 2 and np.isfinite(x).all()
    no_shapes = np.zeros((0, motion.x.shape[1]))
    return {"shape_x": x if has_cycle else no_shapes, "shape_y": y if has_cycle else no_shapes}


def _limit_cycle_job(state: PageState, **options: int) -> Job:
    rod = dict(dimensionless_parameters_of(state.rod_or_arm()))
    request = PortraitRequest(rod=DescribedRod(parameters=rod, material=MATERIAL_SECTION_BY_LAW[state.law]))
    return request.job_of_task("limit_cycle", options, rod["F"])
