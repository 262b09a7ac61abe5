"""The config of every task, by its name; the section of a task's options has that name too."""

from .branch import BranchConfig
from .criticality import CriticalityConfig
from .limit_cycle import LimitCycleConfig
from .modes import ModesConfig
from .phase_diagram import PhaseDiagramConfig
from .schema import Config
from .spectrum import SpectrumConfig
from .thresholds import ThresholdsConfig

CONFIGS: dict[str, type[Config]] = {
    "spectrum": SpectrumConfig,
    "thresholds": ThresholdsConfig,
    "phase_diagram": PhaseDiagramConfig,
    "modes": ModesConfig,
    "limit_cycle": LimitCycleConfig,
    "criticality": CriticalityConfig,
    "branch": BranchConfig,
}
