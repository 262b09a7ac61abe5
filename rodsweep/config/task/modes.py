"""Config of the task modes: leading modes of the straight rod, their adjoints, and transient growth."""

from typing import Literal

from pydantic import model_validator

from ..base_config import LinearConfig, ModeCount, NodeCount
from ..values import StrictConfigSection


class ModesOptions(StrictConfigSection):
    """Options of the task modes: numbers of modes and of nodes, numerical abscissa and transient growth,
    certificate."""

    modes: ModeCount = 2
    """Number of leading modes at each point."""
    nodes: NodeCount = 65
    """Number of Lobatto nodes of each mode."""
    growth: bool = True
    """Compute the numerical abscissa and the transient growth."""
    certify: bool = True
    """Prove by the winding number that no leading mode is missing."""


class ModesConfig(LinearConfig):
    """The task modes computes the leading modes at every point, their adjoint modes, and the
    transient growth of the non-normal operator.
    """

    task: Literal["modes"]
    modes: ModesOptions = ModesOptions()

    @model_validator(mode="after")
    def _require_points(self) -> "ModesConfig":
        self.parameters.require_one_definition_of_points(self.parameter_names)
        return self
