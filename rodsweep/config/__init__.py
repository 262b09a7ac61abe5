"""Reads a YAML config and validates it into a frozen `Config`. Knows the names of parameters, no physics."""

from .base_config import Config
from .document.parsing import refusals_naming_file
from .document.reading import read_config

__all__ = ["Config", "read_config", "refusals_naming_file"]
