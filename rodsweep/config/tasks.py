"""Config class of every task, by name of the task, which is also the name of the section with the task's
options."""

from typing import Any

from .base_config import Config
from .task.branch import BranchConfig
from .task.criticality import CriticalityConfig
from .task.limit_cycle import LimitCycleConfig
from .task.modes import ModesConfig
from .task.phase_diagram import PhaseDiagramConfig
from .task.spectrum import SpectrumConfig
from .task.thresholds import ThresholdsConfig

CONFIG_CLASSES_BY_TASK: dict[str, type[Config]] = {
    "spectrum": SpectrumConfig,
    "thresholds": ThresholdsConfig,
    "phase_diagram": PhaseDiagramConfig,
    "modes": ModesConfig,
    "limit_cycle": LimitCycleConfig,
    "criticality": CriticalityConfig,
    "branch": BranchConfig,
}


def makes_diagram(task: str) -> bool:
    """Whether the points of the task named `task` are the rows of a phase diagram over two parameters."""
    parameters: Any = CONFIG_CLASSES_BY_TASK[task].model_fields["parameters"].annotation
    return bool(parameters.in_diagram)
