"""One module per task: a task connects config and points with a solver and the variables of the file.

A new task needs a module of the same name here, in `rodsweep.config.task`, `rodsweep.results.layouts`,
`rodsweep.post.summary` and `rodsweep.post.figures`, and an entry in the registry of each stage. The registry
of configs is `rodsweep.config.tasks`; the registry of every other stage is in its package.
"""

from collections.abc import Callable
from typing import Any

from ..sweep.points.points import Points
from .branch import BranchTask
from .criticality import CriticalityTask
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
    "criticality": CriticalityTask,
    "branch": BranchTask,
}
"""Constructor of each task, from (config, points). Raises InputError for errors that only the task
detects."""
