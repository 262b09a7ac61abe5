"""Kinds of thresholds along a path of rods, and one threshold.

At a threshold a pair of eigenvalues crosses the imaginary axis, or the leading eigenvalue changes between
real and complex (an exchange). `crossing_kind` gives the kind of a crossing; `leader_exchanges` gives the
kind of an exchange, and `unstable_modes` finds which crossing is a restabilization.
"""

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...determinant.parameter_path import (
        ParameterPath,  # for annotations only: the module imports solvers
    )


class ThresholdKind(IntEnum):
    """Kind of a threshold along a path, named for increasing parameter.

    onset, real_again: two real leading eigenvalues become a pair; a pair becomes two real eigenvalues.
    pair_leads, real_leads: a pair overtakes a real eigenvalue; a real eigenvalue overtakes a pair. hopf,
    hopf_reverse: a pair becomes unstable; a pair becomes stable. restabilization: the last unstable pair
    becomes stable.
    """

    onset = 1
    hopf = 2
    hopf_reverse = 3
    restabilization = 4
    real_again = 5
    real_leads = 6
    pair_leads = 7

    @property
    def switches_real_and_complex(self) -> bool:
        """Whether the leading eigenvalue changes between real and complex at this threshold. Otherwise a pair
        crosses the imaginary axis."""
        return self in (
            ThresholdKind.onset,
            ThresholdKind.pair_leads,
            ThresholdKind.real_again,
            ThresholdKind.real_leads,
        )

    @property
    def pair_leads_after(self) -> bool:
        """Whether a real leading eigenvalue gives way to a complex pair at this threshold (onset or
        pair_leads)."""
        return self in (ThresholdKind.onset, ThresholdKind.pair_leads)


@dataclass(frozen=True, slots=True)
class Threshold:
    """One threshold along a path. value, error: value of the parameter and its absolute error. growth_rate,
    frequency: real and imaginary part of the eigenvalue, in 1/tau2.

    unstable_after: number of unstable modes just after the threshold, -1 if unknown. frequency_error: error
    of the frequency of a pair that crosses the imaginary axis; nan at an exchange of the leading eigenvalue.
    """

    value: float
    kind: ThresholdKind
    """Kind of the change of the spectrum, named for increasing parameter."""
    frequency: float
    growth_rate: float
    error: float
    unstable_after: int = -1
    frequency_error: float = math.nan


def crossing_kind(path: "ParameterPath", grows_with_path_variable: bool) -> ThresholdKind:
    """Kind of a crossing of the imaginary axis by a pair: hopf if the growth rate Re w increases with the
    parameter of `path`, otherwise hopf_reverse. grows_with_path_variable: whether Re w increases with the
    path variable p, which decreases as the parameter increases along a stiffness, p = 1/k."""
    grows_with_parameter = grows_with_path_variable != path.is_compliance_path
    return ThresholdKind.hopf if grows_with_parameter else ThresholdKind.hopf_reverse
