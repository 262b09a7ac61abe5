"""Spectra of arms that vary along their length, so that D has no closed form.

The contenders of the race ARM_SPECTRUM_RACE_NAME are functions of `UncachedArms` that return at least the
MODE_COUNT leading eigenvalues, (modes,).
"""

from collections.abc import Callable, Sequence
from functools import partial
from math import inf, nextafter
from typing import Any

from ...arrays import Complex, list_of
from ...determinant.arm.determinant import ArmDeterminant
from ...discretization.straight.arm_resolution import ArmMesh, arm_mesh
from ...model.material.profile import Profile
from ...model.material.rod_material import RodMaterial
from ...model.rod import Rod
from ...solve.spectrum.arm_solver import arm_solver
from ...solve.spectrum.problem import ArmProblem
from ...wording import counted
from ..study import Measurement, TimedMethod, measure_case
from .rodsweep_and_exact_spectra import (
    CERTIFIED_NAME,
    KRYLOV_SCHUR_NAME,
    MODE_COUNT,
    PENCIL_GROUP,
    RODSWEEP_GROUP,
    UNCERTIFIED_NAME,
    error_as_measurement_field,
    leading_eigenvalues,
    rodsweep_spectrum,
    table_by_case,
)

ARM_SPECTRUM_RACE_NAME = "arms"
"""Name of the race of spectra of arms."""
FIVE_SEGMENT_PROFILE = Profile(
    (0.0, 0.2, 0.2, 0.4, 0.4, 0.6, 0.6, 0.8, 0.8, 1.0),
    tuple((r**2, r**2, r**4, 1.0, 1.0, r**2) for r in (1.0, 1.0, 0.6, 0.6, 1.2, 1.2, 0.5, 0.5, 0.8, 0.8)),
)
"""Profile of an arm of five segments, with radii of 1, 0.6, 1.2, 0.5 and 0.8 times the radius at the
clamp."""
RUBBER = RodMaterial("neo_hookean", "swelling")
ARM_RODS = {
    "cone": Rod(F=12.0, k1=1e4, k2=1e2, gamma3=1e-2, taper=0.5),
    "five segments": Rod(
        F=4.0, k1=1e4, k2=1e4, gamma3=1e-4, material=RodMaterial(profile=FIVE_SEGMENT_PROFILE)
    ),
    "cone of rubber": Rod(F=16.0, k1=2e2, k2=1e4, gamma3=1e-4, taper=0.5, material=RUBBER),
}
ELEMENT_ORDERS = (6, 8, 10, 12, 14, 16, 20)
"""Orders of the elements on which eigensolvers are run."""
ELEMENT_EDGE_ACCURACY = 1e-2
"""Relative accuracy for which the edges of the elements are chosen; the orders in ELEMENT_ORDERS make the
mesh more accurate."""
TARGET_ERROR = 1e-10
"""Relative error at which the methods are compared."""
MAX_RESOLVED_W_RATIO_OF_REFERENCE = 16.0
"""The reference D at w has elements that resolve moduli up to this number times |w|."""
NEWTON_STEP_COUNT = 3
"""Number of Newton steps with the reference D."""


class UncachedArms:
    """Source of arms that are in no cache: rodsweep caches solved arms, so F grows by one rounding unit with
    each arm. rod: the arm before the first."""

    def __init__(self, rod: Rod):
        self._values = dict(rod.values)
        self._material = rod.material

    def next_arm(self) -> Rod:
        """The next arm; its F is one rounding unit larger."""
        self._values["F"] = nextafter(self._values["F"], inf)
        return Rod(**self._values, material=self._material)


def exact_arm_spectrum(rod: Rod) -> list[complex]:
    """The MODE_COUNT leading eigenvalues of an arm, by Newton's method for D, with elements finer than in
    `rodsweep`."""
    determinant = ArmDeterminant(rod)
    roots: list[complex] = list_of(rodsweep_spectrum(rod, certify=True))
    for _ in range(NEWTON_STEP_COUNT):
        values = [determinant.value_on_finer_elements(w, MAX_RESOLVED_W_RATIO_OF_REFERENCE) for w in roots]
        roots = [w - value.D / value.D_w for w, value in zip(roots, values, strict=True)]
    return roots


def measure_arm_spectra(peers: Sequence[TimedMethod], round_count: int) -> list[Measurement]:
    """Measurements of rodsweep, Krylov-Schur and the peers on all ARM_RODS, at all sizes of the
    eigenproblem."""
    measurements = []
    for name, rod in ARM_RODS.items():
        measure_error = partial(error_as_measurement_field, exact_arm_spectrum(rod))
        measurements += measure_case(
            name, UncachedArms(rod), [*contenders(), *peers], round_count, measure_error
        )
    return measurements


def arm_table(measurements: Sequence[Measurement], round_count: int) -> str:
    """Table of the time and error of every method on every arm, at the fastest size with an error of at most
    TARGET_ERROR, after a paragraph that explains the table."""
    return (
        f"Leading {MODE_COUNT} eigenvalues of arms to {TARGET_ERROR:.0e}: ms and error of the cheapest size "
        f"that reaches this error, {counted(round_count, 'round')}. Cones have half the radius at their "
        "tips, the segments have radii of 1, 0.6, 1.2, 0.5 and 0.8, and rubber is neo-Hookean with a "
        "swelling section. Errors are relative distances from the roots of D, with elements that resolve 16 "
        "times the |w|:\n\n"
    ) + table_by_case(ARM_RODS, measurements, _cheapest_time_cell)


def _cheapest_time_cell(measurements: Sequence[Measurement]) -> str:
    """Cell of `arm_table` for one method on one arm."""
    accurate = [m for m in measurements if m.error <= TARGET_ERROR]
    if not accurate:
        return f"no better than {min(m.error for m in measurements):.0e}"
    fastest = min(accurate, key=lambda m: m.seconds)
    return f"{1e3 * fastest.seconds:.2f} ms, {fastest.error:.0e}"


def mesh_of_arm(rod: Rod, order: int) -> ArmMesh:
    """Mesh of an arm with elements of the order `order`; their edges suffice for ELEMENT_EDGE_ACCURACY."""
    return ArmMesh(arm_mesh(rod, MODE_COUNT, ELEMENT_EDGE_ACCURACY).edges, order)


def solve_next_arm(solve: Callable[[Rod, Any], Complex], option: int, arms: UncachedArms) -> Complex:
    """Eigenvalues, (modes,), of the next arm of `arms` by the eigensolver `solve`. option: second argument of
    `solve`: an order, a number of intervals, or whether rodsweep certifies the eigenvalues."""
    return solve(arms.next_arm(), option)


def _krylov_schur(rod: Rod, order: int) -> Complex:
    """Leading eigenvalues, (modes,), of an arm by SLEPc's Krylov-Schur on elements of the given order,
    without Newton's method for D."""
    solver = arm_solver(mesh_of_arm(rod, order))
    eigenvalues = solver.solve(rod, ArmProblem(rod).shift, MODE_COUNT, to_rounding=True)
    return leading_eigenvalues(eigenvalues, MODE_COUNT + 1)


def contenders() -> list[TimedMethod]:
    """Contenders of ARM_SPECTRUM_RACE_NAME: rodsweep without and with certificate, and Krylov-Schur at all
    orders."""
    certify_options = {UNCERTIFIED_NAME: False, CERTIFIED_NAME: True}
    runs = {
        name: partial(solve_next_arm, rodsweep_spectrum, certify) for name, certify in certify_options.items()
    }
    krylov = [
        TimedMethod(
            KRYLOV_SCHUR_NAME, str(order), PENCIL_GROUP, partial(solve_next_arm, _krylov_schur, order)
        )
        for order in ELEMENT_ORDERS
    ]
    return [TimedMethod(name, "", RODSWEEP_GROUP, run) for name, run in runs.items()] + krylov
