"""What the user asks for: YAML to a validated, frozen `Config`. Knows no physics and no files but YAML."""

from .limit_cycle import LimitCycleConfig
from .reading import load_config
from .schema import Config, ModesConfig, PhaseDiagramConfig, SpectrumConfig, ThresholdsConfig

__all__ = [
    "Config",
    "LimitCycleConfig",
    "ModesConfig",
    "PhaseDiagramConfig",
    "SpectrumConfig",
    "ThresholdsConfig",
    "load_config",
]
