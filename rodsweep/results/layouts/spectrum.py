"""What the file of the task spectrum holds."""

from typing import Any

from .eigenvalues import EACH_MODE, EACH_POINT, VECTORS
from .variables import Layout


def layout(config: dict[str, Any]) -> Layout:
    """The layout that a resolved config asks for; vectors only where asked for."""
    options = config["spectrum"]
    extents = {"mode": options["modes"]}
    if not options["vectors"]:
        return Layout(EACH_MODE + EACH_POINT, extents)
    return Layout(EACH_MODE + VECTORS + EACH_POINT, extents | {"u": options["nodes"]})
