"""Whether a peer is there: its Python module where it is installed."""

import importlib
from typing import Any


def installed(module: str) -> Any | None:
    """A peer's module; None where it is not installed."""
    try:
        return importlib.import_module(module)
    except ImportError:
        return None
