"""The keys of the task modes."""

from typing import Literal

from pydantic import model_validator

from .schema import LinearConfig, Modes, Nodes
from .values import Strict


class ModesOptions(Strict):
    """What the task modes computes at each point."""

    modes: Modes = 2
    """Leading modes at each point."""
    nodes: Nodes = 65
    """Lobatto nodes on which the modes are given."""
    growth: bool = True
    """Whether the numerical abscissa and the transient growth are computed."""
    certify: bool = True
    """Prove by the winding number that no leading mode is missing."""


class ModesConfig(LinearConfig):
    """The leading modes at every point, with their adjoints, and what non-normality makes of them."""

    task: Literal["modes"]
    modes: ModesOptions = ModesOptions()

    @model_validator(mode="after")
    def _whole_points(self) -> "ModesConfig":
        self.parameters.require(self.names)
        return self
