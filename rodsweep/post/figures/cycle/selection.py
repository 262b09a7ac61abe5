"""Selection of the limit cycles or transients of a result file that a figure shows.

Samples and shapes of a cycle are at the times k T/n, k = 0 ... n - 1, of a period T. The sample at the time T
would equal the first sample.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array, list_of
from ....errors import InputError
from ....results.file.view import ResultView
from ...summary.number_texts import rounded_text
from ..arm.quantities import parameters_given_beside_arm, quantities_at_point, quantity_text
from ..style import heading_text, parameter_text
from .units_and_labels import DIMENSIONLESS_UNITS, QUANTITIES_REQUIRED_FOR_UNITS, CycleUnits, units_at_points

MAX_CYCLES = 3
"""Largest number of cycles that fit side by side into one figure."""
SHAPE_VARIABLE_NAMES = ("shape_x", "shape_y", "shape_theta")
"""Names of the variables with the shapes over a period."""
ENERGY_BUDGET_VARIABLE_NAMES = ("energy", "injection", "dissipation")
"""Names of the variables with the energy budget over a period."""
TRANSIENT_VARIABLE_NAMES = ("transient_time", "transient_x", "transient_y")
"""Names of the variables with the motion from the initial state."""
CONFIG_OPTION_BY_VARIABLE = dict.fromkeys(SHAPE_VARIABLE_NAMES, "shapes") | dict.fromkeys(
    TRANSIENT_VARIABLE_NAMES, "transient"
)
"""Name of the option of limit_cycle that, if positive, makes the task store a variable, by name of the
variable. Variables over a period that are not listed are stored with the option `samples`."""


@dataclass(frozen=True, slots=True)
class StoredCycle:
    """Limit cycle or transient at one point of a result file. parameters: parameters of the point, by
    name. values: variables in `units`, by name. period: NaN if there is no cycle."""

    number: int
    """Number of the point in the file, from 1."""
    label: str
    """Text of the parameters in which this cycle differs from the other cycles of the figure."""
    parameters: dict[str, float]
    period: float
    values: dict[str, Array]
    status_name: str = "cycle"
    """Status of the point, as a word."""
    units: CycleUnits = DIMENSIONLESS_UNITS

    @property
    def tau1(self) -> float:
        """Short time scale tau1 = gamma3/k2, in tau2. 0 if gamma3 = 0 or k2 = inf, and for an arm, whose
        values are in SI units."""
        if self.units.in_si:
            return 0.0
        return self.parameters["gamma3"] / self.parameters["k2"]

    @property
    def period_text(self) -> str:
        """The period as TeX, rounded according to its error; a line can be broken after the symbol T."""
        if self.units.in_si:
            return f"$T$ = {self.units.time_text(self.period)}"
        return self._period_with_unit_text(self.period, r"\tau_2", r"T\,")

    @property
    def period_in_tau1_text(self) -> str:
        """The period in units of tau1 as TeX; empty for a rod without tau1."""
        return (
            self._period_with_unit_text(self.period / self.tau1, r"\tau_1") if 0 < self.tau1 < np.inf else ""
        )

    def _period_with_unit_text(self, value: float, unit: str, symbol: str = "") -> str:
        """A period with its unit as TeX. value: the period in `unit`. symbol: symbol before the equals sign,
        or empty."""
        error = float(self.values["period_error"])
        return rf"${symbol}{{=}}$ ${rounded_number_in_tex(rounded_text(value, abs(value) * error))}\,{unit}$"

    @property
    def tip_path(self) -> tuple[Array, Array]:
        """Returns (x, y) of the tip over a period, from the samples if stored, else from the shapes."""
        if "tip_x" in self.values:
            return self.values["tip_x"], self.values["tip_y"]
        return self.values["shape_x"][:, -1], self.values["shape_y"][:, -1]

    @property
    def has_transient(self) -> bool:
        """Whether the motion from the initial state is stored."""
        times = self.values.get(TRANSIENT_VARIABLE_NAMES[0])
        return times is not None and bool(np.isfinite(times).all())

    def heading(self, *lines: str) -> str:
        """Title of a panel: the label, if not empty, above the given lines."""
        return "\n".join(filter(None, (self.label, *lines)))


def rounded_number_in_tex(number: str) -> str:
    """TeX for a number written by `rounded_text`, with the power of ten as a superscript."""
    mantissa, _, power = number.partition("e")
    return rf"{mantissa}\times10^{{{int(power)}}}" if power else mantissa


@dataclass(frozen=True, slots=True)
class CycleSelection:
    """Cycles that one figure shows."""

    cycles: list[StoredCycle]
    """The cycles, at most MAX_CYCLES."""
    title: str
    """Title of the file, and text of the parameters that all cycles share."""
    omissions_clause: str
    """Clause on cycles that the figure leaves out; empty if all cycles are shown."""


def chosen_cycles(view: ResultView, points: Sequence[int], variable_names: Sequence[str]) -> CycleSelection:
    """Stable cycles at the points with the numbers `points`, or the first stable cycles, at most MAX_CYCLES,
    if `points` is empty. Raises InputError if a point, a stable cycle or a variable is missing, or for more
    than MAX_CYCLES points."""
    _require_variables(view, variable_names)
    complaint = "the point has no cycle to draw; its status is {status}; choose another"
    return _selected_cycles(view, points, view.status_names == "cycle", "cycle", complaint)


def chosen_transients(view: ResultView, points: Sequence[int]) -> CycleSelection:
    """Motions from the initial state at the points with the numbers `points`, or the first stored motions, at
    most MAX_CYCLES, if `points` is empty. Raises InputError if a chosen motion, every motion or a variable is
    missing, if a point does not exist, or if more than MAX_CYCLES points are chosen."""
    _require_variables(view, TRANSIENT_VARIABLE_NAMES)
    is_stored = np.isfinite(view.variables[TRANSIENT_VARIABLE_NAMES[0]][..., -1].ravel())
    complaint = (
        "the motion of this point from its initial state is not stored; choose a point that was integrated "
        "from its initial state"
    )
    return _selected_cycles(view, points, is_stored, "transient", complaint)


def _require_variables(view: ResultView, variable_names: Sequence[str]) -> None:
    """Raises InputError if one of the variables `variable_names` is missing; the message names the option
    with which the variable is stored."""
    for name in variable_names:
        if name not in view.variables:
            key = f"limit_cycle.{CONFIG_OPTION_BY_VARIABLE.get(name, 'samples')}"
            raise InputError(f"{view.path} holds no {name}; run with {key} > 0, which stores it")


def _selected_cycles(
    view: ResultView, points: Sequence[int], is_drawable: NDArray[np.bool_], noun: str, complaint: str
) -> CycleSelection:
    """Selection of the points with the numbers `points` or, if `points` is empty, of the first points that
    can be drawn. is_drawable: whether each point can be drawn, (points,). noun: word for what is drawn, for
    messages. complaint: message on a chosen point that cannot be drawn, with `{status}`. Raises InputError if
    a chosen point, or no point at all, can be drawn."""
    statuses = view.status_names
    status_words = [word.replace("_", " ") for word in list_of(statuses)]
    if len(points) > MAX_CYCLES:
        limit_sentence = f"one figure shows at most {MAX_CYCLES} points"
        raise InputError(f"--point is given {len(points)} times; {limit_sentence}")
    for number in points:
        if not 1 <= number <= statuses.size:
            raise InputError(f"--point {number}: {view.path} has the points 1 to {statuses.size}")
        if not is_drawable[number - 1]:
            raise InputError(f"--point {number}: {complaint.format(status=status_words[number - 1])}")
    available = np.flatnonzero(is_drawable) + 1
    if not available.size:
        reason = f"the statuses of its points are: {', '.join(sorted(set(status_words)))}"
        raise InputError(f"{view.path} holds no {noun} that could be drawn; {reason}")
    numbers = list(points) or list_of(available[:MAX_CYCLES])
    columns = view.point_columns
    common_text, labels = shared_and_own_texts_of_points(view, numbers)
    cycles = []
    for number, label, units in zip(numbers, labels, units_at_points(view, numbers), strict=True):
        parameters = {name: float(column[number - 1]) for name, column in columns.items()}
        stored = view.point_values(number - 1).items()
        values = units.converted({n: v for n, v in stored if n not in (*view.parameters, "point")})
        word = str(statuses[number - 1])
        cycles.append(StoredCycle(number, label, parameters, float(values["period"]), values, word, units))
    omissions_clause = ""
    if not points and available.size > len(cycles):
        omissions_clause = f", the first {len(cycles)} of {available.size} {noun}s (--point chooses others)"
    return CycleSelection(cycles, heading_text(view, common_text), omissions_clause)


def _split_shared_texts(texts: Sequence[Mapping[str, str]]) -> tuple[str, list[str]]:
    """Returns (shared, own): the texts that all mappings share, and the other texts of each mapping."""
    shared = {name: text for name, text in texts[0].items() if all(each[name] == text for each in texts)}
    own = [", ".join(text for name, text in each.items() if name not in shared) for each in texts]
    return ", ".join(shared.values()), own


def shared_and_own_texts(parameters: Sequence[dict[str, float]]) -> tuple[str, list[str]]:
    """Returns (shared, own): text of the parameters with equal values in all mappings, and text of the other
    parameters of each mapping."""
    return _split_shared_texts(
        [{name: parameter_text({name: value}) for name, value in each.items()} for each in parameters]
    )


def shared_and_own_texts_of_points(view: ResultView, numbers: Sequence[int]) -> tuple[str, list[str]]:
    """Returns (shared, own): text of the parameters that are equal at all points, and text of the other
    parameters of each point; for an arm, of the quantities. numbers: numbers of the points, from 1."""
    if all(name in view.quantities for name in QUANTITIES_REQUIRED_FOR_UNITS):
        return shared_and_own_texts_of_arms(view, numbers)
    columns = view.point_columns
    return shared_and_own_texts(
        [{name: float(columns[name][number - 1]) for name in columns} for number in numbers]
    )


def shared_and_own_texts_of_arms(
    view: ResultView, numbers: Sequence[int], omitted: Collection[str] = ()
) -> tuple[str, list[str]]:
    """Returns (shared, own): text of the quantities that are equal for all arms, and text of the other
    quantities of each arm, in the units typed by the user.

    numbers: numbers of the points of the arms, from 1. omitted: quantities and parameters that are left out,
    for example because they are on axes.
    """
    texts_of_arms = []
    for number in numbers:
        quantities = quantities_at_point(view, number).items()
        texts = {name: quantity_text(view, name, value) for name, value in quantities}
        texts |= {
            n: parameter_text({n: value}) for n, value in parameters_given_beside_arm(view, number).items()
        }
        texts_of_arms.append({name: text for name, text in texts.items() if name not in omitted})
    return _split_shared_texts(texts_of_arms)
