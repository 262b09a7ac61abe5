"""What the user asks for: YAML to a validated, frozen `Config`. Knows the names of parameters, no physics."""

from .document.reading import load_config
from .schema import Config

__all__ = ["Config", "load_config"]
