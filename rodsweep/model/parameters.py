"""The table of parameters: name, unit, range, symbol and meaning of every parameter.

Axes of a config, headers of point lists, range checks, dimensions and units in result files, and labels of
figures are made from this table.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from math import inf, isfinite
from typing import TypeVar

Decorated = TypeVar("Decorated")
STIFFNESS_NAMES = ("k1", "k2")
"""Names of the stiffnesses k. The equations contain the compliances 1/k."""


@dataclass(frozen=True, slots=True)
class Range:
    """Allowed values of a parameter, as a predicate and as a phrase for messages. No range contains NaN."""

    contains: Callable[[float], bool]
    description: str
    """The range as a phrase for messages on invalid values, like "a finite number above 0"."""
    schema_bounds: Mapping[str, float] = field(default_factory=dict)
    """Bounds of the range by JSON schema keyword, like {"minimum": 0}; empty if every number is allowed."""
    exclusion_reason: str = ""
    """Why some finite numbers above 0 lie outside the range, in parentheses, for messages."""

    def description_for_rejected(self, value: float) -> str:
        """The description of the range, for a message on `value` outside the range; with `exclusion_reason`
        if `value` is a finite number above 0."""
        return (
            f"{self.description} {self.exclusion_reason}"
            if self.exclusion_reason and 0 < value < inf
            else self.description
        )

    def finite_description_for_rejected(self, value: float) -> str:
        """`description_for_rejected` where only finite values are allowed: the text does not offer inf, even
        if the range contains inf."""
        description = self.description.partition(", or inf")[0]
        if "finite" not in description:
            description = description.replace("a number", "a finite number")
        return description + self.description_for_rejected(value).removeprefix(self.description)

    def first_outside(self, values: Iterable[float]) -> float | None:
        """The first number in `values` that lies outside the range; None if the range contains all values."""
        return next((value for value in map(float, values) if not self.contains(value)), None)


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One parameter of the rod, an element of the table `PARAMETERS`. unit: unit of the value. meaning:
    phrase for messages, files and figures. allowed_range: range of the value."""

    name: str
    """Name of the parameter in code, configs and result files."""
    symbol: str
    """Symbol of the paper, in TeX."""
    unit: str
    meaning: str
    meaning_suffix: str = ""
    """Text that is appended to the meaning of the parameter in result files."""
    allowed_range: Range
    is_in_linear_problem: bool = True
    """Whether the transverse linear problem contains the parameter."""
    rigid_adjective: str = ""
    """Adjective for a rod whose parameter is inf, like "inextensible"; empty if inf is not allowed."""
    is_optional: bool = False
    """Whether a result file contains the parameter only if the config contains it."""
    default: float | None = None
    """Value of the parameter if a config does not contain it; None if every grid must contain it."""
    scaled_coefficient_names: tuple[str, ...] = ()
    """Names of the stiffnesses or drags that the value multiplies; empty for a load, a stiffness or a drag. A
    parameter may multiply either stiffnesses or drags, not both, because the proof that no crossing on a path
    is missing requires equations that are affine in the coordinate of the parameter."""

    def __post_init__(self) -> None:
        """Raises ValueError if the parameter scales both stiffnesses and drags."""
        # Along such a path some coefficients would be affine in the value and others in its inverse.
        if len({name in STIFFNESS_NAMES for name in self.scaled_coefficient_names}) > 1:
            raise ValueError(
                f"{self.name} scales {' and '.join(self.scaled_coefficient_names)}; "
                "a parameter may scale either stiffnesses or drags"
            )

    @property
    def has_inverse_coordinate(self) -> bool:
        """Whether the coordinate of the parameter is 1/value; then the value may be inf."""
        return bool(self.rigid_adjective or set(self.scaled_coefficient_names) & set(STIFFNESS_NAMES))

    def coordinate(self, value: float) -> float:
        """The coordinate, in which the equations are affine: 1/value if `has_inverse_coordinate`, as for a
        stiffness, otherwise the value."""
        return 1 / value if self.has_inverse_coordinate else value

    def value(self, coordinate: float) -> float:
        """Value of the parameter with the given coordinate: 1/coordinate (inf for 0) if
        `has_inverse_coordinate`, otherwise the coordinate."""
        if self.has_inverse_coordinate:
            return 1 / coordinate if coordinate else inf
        return coordinate

    @property
    def neutral_value(self) -> float:
        """The default of the parameter; without a default, inf for a stiffness and 0 otherwise: valid for
        every rod."""
        return self.value(0.0) if self.default is None else self.default

    @property
    def long_name(self) -> str:
        """`meaning` and `meaning_suffix`, for the attribute `long_name` in result files."""
        return self.meaning + self.meaning_suffix

    def require_in_range(self, value: float) -> None:
        """Raises ValueError for a value outside the range of the parameter. `Rod` checks F < k1."""
        if not self.allowed_range.contains(value):
            raise ValueError(
                f"{self.name} = {value} is not {self.allowed_range.description_for_rejected(value)}"
            )


MIN_TAPER = 0.01
MAX_TAPER = 100.0
"""MIN_TAPER, MAX_TAPER: range of the taper. Taper 0 is excluded: a point has no stiffness."""


def stiffness_parameter(name: str, symbol: str, meaning: str, rigid_adjective: str) -> Parameter:
    """The table row of a stiffness that may be inf. name, symbol, meaning: fields of `Parameter`.
    rigid_adjective: adjective for a rod with infinite stiffness."""
    return Parameter(
        name=name,
        symbol=symbol,
        unit="k3/L^2",
        meaning=meaning,
        meaning_suffix=f"; inf is {rigid_adjective}",
        allowed_range=Range(
            lambda value: value > 0 and 1 / value < inf,
            f"a number above 0, or inf for an {rigid_adjective} rod",
            {"exclusiveMinimum": 0},
            f"(1/{name} overflows)",
        ),
        rigid_adjective=rigid_adjective,
    )


PARAMETERS = {
    parameter.name: parameter
    for parameter in (
        Parameter(
            name="F",
            symbol=r"\tilde F",
            unit="k3/L^2",
            meaning="follower force",
            meaning_suffix=" at the tip, along -e1",
            allowed_range=Range(isfinite, "a finite number below k1 (negative values pull)"),
        ),
        stiffness_parameter("k1", r"\tilde k_1", "stretch stiffness", "inextensible"),
        stiffness_parameter("k2", r"\tilde k_2", "shear stiffness", "unshearable"),
        Parameter(
            name="gamma3",
            symbol=r"\tilde\gamma_3",
            unit="gamma2 L^2",
            meaning="rotational drag",
            allowed_range=Range(
                lambda value: 0 <= value < inf, "a finite number, 0 or above", {"minimum": 0}
            ),
        ),
        Parameter(
            name="gamma1",
            symbol=r"\tilde\gamma_1",
            unit="gamma2",
            meaning="axial drag",
            allowed_range=Range(
                lambda value: 0 < value < inf, "a finite number above 0", {"exclusiveMinimum": 0}
            ),
            is_in_linear_problem=False,
            default=1.0,
        ),
        Parameter(
            name="taper",
            symbol=r"r(1)/r(0)",
            unit="1",
            meaning="tip radius over base radius",
            meaning_suffix=" of a circular cone",
            allowed_range=Range(
                lambda value: MIN_TAPER <= value <= MAX_TAPER,
                f"a number from {MIN_TAPER:g} to {MAX_TAPER:g}",
                {"minimum": MIN_TAPER, "maximum": MAX_TAPER},
            ),
            is_optional=True,
            default=1.0,
        ),
    )
}
"""All parameters of the rod by name, in the order of configs, result files and tables."""

NONLINEAR_ROD_PARAMETER_NAMES = tuple(
    name for name, parameter in PARAMETERS.items() if not parameter.is_optional
)
"""Names of the parameters of the nonlinear rod, without the optional parameters."""
NON_OPTIONAL_LINEAR_PARAMETER_NAMES = tuple(
    name for name in NONLINEAR_ROD_PARAMETER_NAMES if PARAMETERS[name].is_in_linear_problem
)
"""Names of the parameters of the transverse linear problem, without the optional parameters."""
OPTIONAL_PARAMETER_NAMES = tuple(name for name, parameter in PARAMETERS.items() if parameter.is_optional)
"""Names of the parameters that a result file contains only if the config contains them."""
SCALING_AND_SCALED_NAMES = tuple(
    (name, scaled) for name, parameter in PARAMETERS.items() for scaled in parameter.scaled_coefficient_names
)
"""All pairs (parameter name, name of a stiffness or drag that the parameter multiplies)."""
TRANSVERSE_PARAMETER_NAMES = (*NON_OPTIONAL_LINEAR_PARAMETER_NAMES, *OPTIONAL_PARAMETER_NAMES)
"""Names of all parameters of the transverse linear problem, optional parameters included."""
RANGE_CHECKS = [(name, parameter.allowed_range.contains) for name, parameter in PARAMETERS.items()]
"""(name, predicate) of every parameter; the predicate is True for values in the range. The list is prepared
once, because sweeps create many rods."""
FORCE_AND_STRETCH_STIFFNESS = ("F", "k1")
"""Names of the force and of the stretch stiffness: a rod of linear material is crushed if F >= k1."""


def parameter_names_except(
    excluded: str, names: tuple[str, ...] = NON_OPTIONAL_LINEAR_PARAMETER_NAMES
) -> tuple[str, ...]:
    """All names in `names` except `excluded`. names: by default `NON_OPTIONAL_LINEAR_PARAMETER_NAMES`."""
    return tuple(name for name in names if name != excluded)


def with_parameter_fields(cls: type[Decorated]) -> type[Decorated]:
    """Class decorator that adds every parameter of `PARAMETERS`, in order, as a field with its default."""
    # Fields of a dataclass are in the order of the annotations, so the parameters must come first.
    own_annotations = dict(cls.__annotations__)
    cls.__annotations__ = dict.fromkeys(PARAMETERS, float) | {
        name: annotation for name, annotation in own_annotations.items() if name not in PARAMETERS
    }
    for name, parameter in PARAMETERS.items():
        if parameter.default is not None:
            setattr(cls, name, parameter.default)
    return cls
