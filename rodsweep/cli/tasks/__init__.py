"""What each task brings to the generic parts of the command line: one module per task.

A new task needs its config (`rodsweep.config.schema`), its layout (`rodsweep.results.layouts`), a module
here, and a summary and a figure in `rodsweep.post`.
"""

from collections.abc import Callable
from typing import Any

from ...config import Config
from ...sweep.grid import Points
from .limit_cycle import LimitCycleTask
from .modes import ModesTask
from .phase_diagram import PhaseDiagramTask
from .protocol import Task
from .spectrum import SpectrumTask
from .thresholds import ThresholdsTask

TASKS: dict[str, Callable[[Any, Points], Task]] = {
    "spectrum": SpectrumTask,
    "thresholds": ThresholdsTask,
    "phase_diagram": PhaseDiagramTask,
    "modes": ModesTask,
    "limit_cycle": LimitCycleTask,
}


def task_of(config: Config, points: Points) -> Task:
    """The task of a config on its points; InputError for what only the task can know to be wrong."""
    return TASKS[config.task](config, points)


def needs_all_points(config: dict[str, Any]) -> bool:
    """Whether a resolved config asks for variables that only all points together give: `Solver.finish`."""
    return config["task"] == "phase_diagram" and bool(config["phase_diagram"]["curves"])
