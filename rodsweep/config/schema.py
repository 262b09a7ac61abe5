"""The keys of a config, their types and defaults: what every task has, and the options of the linear tasks.

Ranges that are physics (F < k1, positive stiffness) belong to `rodsweep.model`; here is form only.
"""

from abc import ABC, abstractmethod
from math import inf
from typing import Annotated, Literal

from pydantic import Field, model_validator

from .values import Axis, Number, Strict, Text, Values

PARAMETERS = ("F", "k1", "k2", "gamma3")
"""Parameters that have an axis in every task, in the order used everywhere."""

Modes = Annotated[int, Field(ge=1, le=100)]
Nodes = Annotated[int, Field(ge=3, le=513)]
Crossings = Annotated[int, Field(ge=1, le=1000)]


class Axes(Strict):
    """Axes, one for each parameter of a grid, or the name of a CSV file that lists points."""

    F: Values | None = None
    k1: Values | None = None
    k2: Values | None = None
    gamma3: Values | None = None
    points: Annotated[Text | None, Field(description="the name of a CSV file")] = None
    """A list of points instead of axes; the header names the parameters."""

    @property
    def axes(self) -> dict[str, Axis]:
        """The axes that are given, by name."""
        found = {name: getattr(self, name, None) for name in (*PARAMETERS, "gamma1")}
        return {name: axis for name, axis in found.items() if isinstance(axis, Axis)}

    def require(self, names: tuple[str, ...], or_points: bool = True) -> None:
        """ValueError unless all axes `names` are given or, where that is allowed, a file of points."""
        if self.points is not None and self.axes:
            both = f"parameters.points and parameters.{next(iter(self.axes))}"
            raise ValueError(f"{both} are both given; give the axes or the file, not both")
        missing = [name for name in names if name not in self.axes]
        if missing and self.points is None:
            hint = ", or points: FILE.csv" if or_points else ""
            raise ValueError(f"parameters.{missing[0]} is missing; give {words(names, 'and')}{hint}")


class Parameters(Axes):
    """The parameters of the linear problem, where axial drag is one number or none."""

    gamma1: Number | None = None


class Config(Strict, ABC):
    """What the config of every task has."""

    title: Annotated[Text, Field(max_length=200)] = ""
    """The name of the run, as `check` and `show` print it."""
    task: str
    parameters: Axes
    accuracy: Annotated[Number, Field(ge=1e-13, le=1e-2)] = 1e-10
    """Relative error of each eigenvalue, threshold and mode."""

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """The parameters that make a point of the sweep."""

    @property
    def constants(self) -> dict[str, float]:
        """Parameters beside `names` that have one value for the whole sweep."""
        gamma1 = getattr(self.parameters, "gamma1", None)
        return {"gamma1": gamma1} if isinstance(gamma1, float) else {}


class LinearConfig(Config, ABC):
    """What the configs of the linear problem share."""

    parameters: Parameters

    @model_validator(mode="after")
    def _gamma1_only_where_used(self) -> "LinearConfig":
        if self.parameters.gamma1 is not None and not isinstance(self, SpectrumConfig):
            raise ValueError(
                f"parameters.gamma1 is given but the task {self.task} does not use it; remove it"
            )
        return self


class SpectrumOptions(Strict):
    """What the task spectrum computes at each point."""

    modes: Modes = 4
    """Leading modes at each point."""
    certify: bool = True
    """Prove by the winding number that none of them is missing."""
    vectors: bool = False
    """Store (Y, Theta), scaled to Y(1) = 1, to about `accuracy`."""
    nodes: Nodes = 33
    """Lobatto nodes on which (Y, Theta) are given, where `vectors` asks for them."""
    longitudinal: bool = False
    """Add the longitudinal modes, -(k1/gamma1) (pi (n - 1/2))^2, in closed form."""


class SpectrumConfig(LinearConfig):
    """The leading eigenvalues at every point."""

    task: Literal["spectrum"]
    spectrum: SpectrumOptions = SpectrumOptions()

    @property
    def names(self) -> tuple[str, ...]:
        return PARAMETERS

    @model_validator(mode="after")
    def _only_what_is_used(self) -> "SpectrumConfig":
        self.parameters.require(PARAMETERS)
        if self.parameters.gamma1 is not None and not self.spectrum.longitudinal:
            raise ValueError(
                "parameters.gamma1 is given but not used: the transverse spectrum does not contain it; "
                "remove it or set spectrum.longitudinal: true"
            )
        if self.spectrum.longitudinal and self.parameters.gamma1 is None:
            raise ValueError("parameters.gamma1 is missing; spectrum.longitudinal: true needs it")
        if "nodes" in self.spectrum.model_fields_set and not self.spectrum.vectors:
            raise ValueError("spectrum.nodes is given but not used; set spectrum.vectors: true or remove it")
        return self


class ThresholdsOptions(Strict):
    """What the task thresholds computes for each rod."""

    F_max: Annotated[Number, Field(gt=0, lt=inf)] = 200.0
    """The search ends here, or just below k1 where that is less."""
    crossings: Crossings = 16
    """The most crossings that are stored."""
    certify: bool = True
    """Confirm by winding numbers between the changes, and certify every spectrum."""


class ThresholdsConfig(LinearConfig):
    """The forces at which the spectrum of every rod changes its kind."""

    task: Literal["thresholds"]
    thresholds: ThresholdsOptions = ThresholdsOptions()

    @property
    def names(self) -> tuple[str, ...]:
        return PARAMETERS[1:]

    @model_validator(mode="after")
    def _finds_the_force_itself(self) -> "ThresholdsConfig":
        if self.parameters.F is not None:
            raise ValueError(
                "parameters.F is given but the task thresholds finds F itself; remove it and set "
                "thresholds.F_max"
            )
        self.parameters.require(self.names)
        return self


class PhaseDiagramOptions(Strict):
    """What the task phase_diagram computes along each row."""

    crossings: Crossings = 16
    """The most crossings that are stored for a row."""
    certify: bool = True
    """Confirm by winding numbers between the changes, and certify every spectrum."""
    curves: bool = True
    """Whether the boundaries between the rows are followed as curves."""


class PhaseDiagramConfig(LinearConfig):
    """What the rod does over two parameters, row by row: a row is a line in the first of the two."""

    task: Literal["phase_diagram"]
    phase_diagram: PhaseDiagramOptions = PhaseDiagramOptions()

    @property
    def plane(self) -> tuple[str, str]:
        """(line axis, row axis): the two parameters with more than one value, in their usual order."""
        line, row = long_axes(self.parameters)
        return line, row

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(name for name in PARAMETERS if name != self.plane[0])

    @model_validator(mode="after")
    def _two_axes(self) -> "PhaseDiagramConfig":
        if self.parameters.points is not None:
            raise ValueError(
                "parameters.points is given but the task phase_diagram needs axes; remove it and give "
                f"{words(PARAMETERS, 'and')}"
            )
        self.parameters.require(PARAMETERS, or_points=False)
        long = long_axes(self.parameters)
        if len(long) != 2:
            raise ValueError(
                f"parameters has {len(long)} axes with more than one value ({', '.join(long) or 'none'}); a "
                f"phase diagram needs exactly two of {words(PARAMETERS, 'and')}"
            )
        line = self.parameters.axes[long[0]]
        if inf in (line.values or ()):
            raise ValueError(
                f"parameters.{long[0]} contains inf, which is not allowed on the axis along which a phase "
                f"diagram is searched; remove it (on the other axis, {long[1]}, k1 and k2 may be inf)"
            )
        return self


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

    @property
    def names(self) -> tuple[str, ...]:
        return PARAMETERS

    @model_validator(mode="after")
    def _whole_points(self) -> "ModesConfig":
        self.parameters.require(PARAMETERS)
        return self


def long_axes(parameters: Axes) -> list[str]:
    """The parameters with more than one value."""
    return [name for name, axis in parameters.axes.items() if axis.size > 1]


def words(names: tuple[str, ...], last: str) -> str:
    """The names as a list in a sentence."""
    return f"{', '.join(names[:-1])} {last} {names[-1]}"
