"""The table of parameters: all that is known of each, stated once.

Axes of a config, headers of point lists, ranges and refusals, dimensions and units in result files, labels of
figures are made of this table. `rodsweep.config` reads it too, and nothing else of the model.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from math import inf, isfinite

STIFFNESSES = ("k1", "k2")
"""The parameters of which the equations contain the inverse, a compliance."""


@dataclass(frozen=True, slots=True)
class Range:
    """What a value may be, for the program and, as a phrase, for the user; NaN lies in none."""

    contains: Callable[[float], bool]
    phrase: str
    bound: Mapping[str, float] = field(default_factory=dict)
    """The least value, in the words of JSON schemas; none where every finite number may be."""

    def first_outside(self, values: Iterable[float]) -> float | None:
        """The first of the values that may not be; None where all may."""
        return next((value for value in map(float, values) if not self.contains(value)), None)


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One parameter of the rod; the nonlinear rod has all of them."""

    name: str
    symbol: str
    """As the paper writes it, in TeX."""
    unit: str
    meaning: str
    remark: str = ""
    """What follows the meaning in the result file."""
    allowed: Range
    linear: bool = True
    """Whether the transverse linear problem contains it."""
    rigid: str = ""
    """What a rod is called whose value is inf; empty where inf is not allowed."""
    optional: bool = False
    """Whether a sweep has the parameter only where its config names it, and stores it only then."""
    default: float | None = None
    """Value for grids that do not name the parameter; None for a parameter that every grid must name."""
    scales: tuple[str, ...] = ()
    """Stiffnesses or drags that the value multiplies; empty where the parameter is itself a load, a stiffness
    or a drag. One parameter scales either stiffnesses or drags, so that the equations are affine in its
    coordinate: the covering of a path needs this."""

    def __post_init__(self) -> None:
        """ValueError where the parameter scales stiffnesses and drags."""
        if len({name in STIFFNESSES for name in self.scales}) > 1:
            raise ValueError(
                f"{self.name} scales {' and '.join(self.scales)}: no coordinate is affine in both"
            )

    @property
    def by_compliance(self) -> bool:
        """Whether the equations are affine in 1/value, which may be 0, instead of the value."""
        return bool(self.rigid or set(self.scales) & set(STIFFNESSES))

    def coordinate(self, value: float) -> float:
        """The number in which the equations are affine: 1/value of a stiffness, which is 0 at inf."""
        return 1 / value if self.by_compliance else value

    def value(self, coordinate: float) -> float:
        """The value at a coordinate; of a stiffness it is inf at 0."""
        if self.by_compliance:
            return 1 / coordinate if coordinate else inf
        return coordinate

    @property
    def neutral(self) -> float:
        """The default, or else the value at the coordinate 0: with it a rod is one if it is with any."""
        return self.value(0.0) if self.default is None else self.default

    @property
    def long_name(self) -> str:
        """The meaning as the result file states it."""
        return self.meaning + self.remark

    def require(self, value: float) -> None:
        """ValueError where the value is not allowed; F < k1 is for `Rod` to check."""
        if not self.allowed.contains(value):
            raise ValueError(f"{self.name} = {value} is not {self.allowed.phrase}")


SMALLEST_TAPER, LARGEST_TAPER = 0.01, 100.0
"""Range of the taper. A point, taper 0, has no stiffness at the tip where the force is."""


def stiffness(name: str, symbol: str, meaning: str, rigid: str) -> Parameter:
    """A stiffness, which is inf for a rod that is called `rigid`; its compliance is a finite number."""
    return Parameter(
        name=name,
        symbol=symbol,
        unit="k3/L^2",
        meaning=meaning,
        remark=f"; inf is {rigid}",
        allowed=Range(
            lambda value: value > 0 and 1 / value < inf,
            f"a number above 0, or inf for an {rigid} rod",
            {"exclusiveMinimum": 0},
        ),
        rigid=rigid,
    )


PARAMETERS = {
    parameter.name: parameter
    for parameter in (
        Parameter(
            name="F",
            symbol=r"\tilde F",
            unit="k3/L^2",
            meaning="follower force",
            remark=" at the tip, along -e1",
            allowed=Range(isfinite, "a finite number below k1 (negative values pull)"),
        ),
        stiffness("k1", r"\tilde k_1", "stretch stiffness", "inextensible"),
        stiffness("k2", r"\tilde k_2", "shear stiffness", "unshearable"),
        Parameter(
            name="gamma3",
            symbol=r"\tilde\gamma_3",
            unit="gamma2 L^2",
            meaning="rotational drag",
            allowed=Range(lambda value: 0 <= value < inf, "a finite number, 0 or above", {"minimum": 0}),
        ),
        Parameter(
            name="gamma1",
            symbol=r"\tilde\gamma_1",
            unit="gamma2",
            meaning="axial drag",
            allowed=Range(lambda value: 0 < value < inf, "a finite number above 0", {"exclusiveMinimum": 0}),
            linear=False,
            default=1.0,
        ),
        Parameter(
            name="taper",
            symbol=r"r(1)/r(0)",
            unit="1",
            meaning="tip radius over base radius",
            remark=" of a circular cone",
            allowed=Range(
                lambda value: SMALLEST_TAPER <= value <= LARGEST_TAPER,
                f"a number from {SMALLEST_TAPER:g} to {LARGEST_TAPER:g}",
                {"minimum": SMALLEST_TAPER, "maximum": LARGEST_TAPER},
            ),
            optional=True,
            default=1.0,
        ),
    )
}
"""All parameters by name, in the order used everywhere."""

NONLINEAR_PARAMETERS = tuple(name for name, parameter in PARAMETERS.items() if not parameter.optional)
"""Names of the parameters of the nonlinear rod, without optional ones."""
LINEAR_PARAMETERS = tuple(name for name in NONLINEAR_PARAMETERS if PARAMETERS[name].linear)
"""Names of the parameters of the linear problem, without optional ones."""
OPTIONAL_PARAMETERS = tuple(name for name, parameter in PARAMETERS.items() if parameter.optional)
"""Names of the optional parameters."""
SCALINGS = tuple((name, scaled) for name, parameter in PARAMETERS.items() for scaled in parameter.scales)
"""(parameter, multiplied stiffness or drag) for every parameter with `scales`."""
CRUSHING = ("F", "k1")
"""The parameters that crush the rod where the first reaches the second."""


def all_but(varied: str, names: tuple[str, ...] = LINEAR_PARAMETERS) -> tuple[str, ...]:
    """The parameters except `varied`; by default parameters of the linear problem."""
    return tuple(name for name in names if name != varied)
