"""Points at which a curve of folds or torus points crosses a row of a phase diagram although no branch of the
row has a special point there: the branch of the row is followed from such a point."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from numpy import array

from ....arrays import Array
from ...orbit.stored_orbit import orbit_arrays, orbit_from_arrays
from .solved_curve_point import CURVE_SECANT_SETTINGS, SolvedCurvePoint
from .special_point import SpecialPoint, SpecialPointKind


@dataclass(frozen=True, slots=True)
class RowCrossing:
    """A crossing of a curve of special points with a row of a phase diagram. row_index: index of the row.
    special_point: the point of the curve on this row, with its orbit on the mesh of the curve."""

    row_index: int
    special_point: SpecialPoint

    @classmethod
    def from_solved_point(
        cls, row_index: int, kind: SpecialPointKind, point: SolvedCurvePoint, error: float
    ) -> "RowCrossing":
        """The crossing with the row of index `row_index` at the point `point` of a curve of special points of
        the kind `kind`. error: absolute error of the branch parameter at the neighbouring points of the
        curve."""
        special_point = SpecialPoint(
            kind=kind,
            parameter_value=point.branch_parameter_value,
            period=point.orbit.period,
            tip_y_max=point.tip_y_max,
            # By chance the error at the neighbours may be below the accuracy of the crossing.
            error=max(
                error, CURVE_SECANT_SETTINGS.relative_parameter_accuracy * abs(point.branch_parameter_value)
            ),
            orbit=point.orbit,
        )
        return cls(row_index, special_point)

    def arrays(self) -> dict[str, Array]:
        """The crossing as named arrays: "crossing", (6,), with the row index, the kind, parameter value,
        tip_y_max and error of the special point, and `is_omega_always_unknown`; then the arrays of the
        orbit."""
        point = self.special_point
        assert point.orbit is not None
        is_omega_always_unknown = point.orbit.form.is_omega_always_unknown
        numbers = (
            self.row_index,
            point.kind,
            point.parameter_value,
            point.tip_y_max,
            point.error,
            is_omega_always_unknown,
        )
        # One array holds all six, so counts and the flag become floats too.
        return {"crossing": array([float(number) for number in numbers])} | orbit_arrays(point.orbit)

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Array]) -> "RowCrossing":
        """The crossing from the named arrays, (...,) each, that the method `arrays` returns."""
        row_index, kind, value, tip_y_max, error, is_omega_always_unknown = map(float, arrays["crossing"])
        orbit = orbit_from_arrays(arrays, bool(is_omega_always_unknown))
        point = SpecialPoint(
            kind=SpecialPointKind(int(kind)),
            parameter_value=value,
            period=orbit.period,
            tip_y_max=tip_y_max,
            error=error,
            orbit=orbit,
        )
        return cls(int(row_index), point)


def numbered_arrays(crossings: Sequence[RowCrossing]) -> dict[str, Array]:
    """The arrays, (...,) each, of all crossings, with the number of the crossing before each name, as in
    "0:mesh"."""
    return {
        f"{number}:{name}": values
        for number, crossing in enumerate(crossings)
        for name, values in crossing.arrays().items()
    }


def crossings_from_arrays(arrays: Mapping[str, Array]) -> tuple[RowCrossing, ...]:
    """The crossings from arrays, (...,) each, with the names that `numbered_arrays` gives; other arrays are
    ignored."""
    parts: dict[int, dict[str, Array]] = {}
    for full_name, values in arrays.items():
        number, separator, name = full_name.partition(":")
        if separator:
            # The names of the half curve itself have no number, and share the mapping with the crossings.
            parts.setdefault(int(number), {})[name] = values
    return tuple(RowCrossing.from_arrays(parts[number]) for number in sorted(parts))
