"""Reads a YAML config and validates it into a frozen `Config`. Knows the names of parameters, no physics."""

from .document.reading import load_config
from .schema import Config

__all__ = ["Config", "load_config"]
