"""What each task brings to the generic parts of the command line: one module per task.

A new task needs a module of its name here, in `rodsweep.config`, `rodsweep.results.layouts`,
`rodsweep.post.summary` and `rodsweep.post.figures`, each with an entry in the registry of its package.
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
"""How a task is made of its config and points; InputError for what only the task can know to be wrong."""
