"""What the user asks for: YAML to a validated, frozen `Config`. Knows no physics and no files but YAML."""

from .reading import load_config
from .schema import Axis, Config, SpectrumOptions

__all__ = ["Axis", "Config", "SpectrumOptions", "load_config"]
