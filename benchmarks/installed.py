"""Optional Python modules of the peers."""

import importlib
from typing import Any


def optional_module(module: str) -> Any | None:
    """The Python module of a peer, by its import name; None if the peer is not installed."""
    try:
        return importlib.import_module(module)
    except ImportError:
        return None
