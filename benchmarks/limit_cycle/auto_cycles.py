"""AUTO-07p continues the cycles of a rod in F, with their Floquet multipliers, on rodsweep's mesh in space.

AUTO collocates at Gauss points over the whole period, starts from a cycle of rodsweep, and takes equal steps
in F. The largest y of the tip is measured as for the integrators: from AUTO's mesh points in time, where
collocation is most accurate.
"""

import re
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rodsweep.arrays import Array, Complex
from rodsweep.bench.limit_cycle.tracking import system_and_state_on_cycle, tip_y_max_near_step
from rodsweep.discretization.explicit_system import ExplicitSystem
from rodsweep.discretization.stress.form import StressForm
from rodsweep.solve.motion.integrator import EndReason, Trajectory
from rodsweep.solve.orbit.orbit import Orbit

from ..auto import AUTO, run_auto, table_lines

NO_CONVERGENCE = "-9"
"""Third word of the last line of AUTO's table fort.7 if Newton's method did not converge."""
AUTO_CONSTANTS = """NDIM={unknowns}, IPS=2, IRS=0, ILP=0, ISP=2, ISW=1, MXBF=0, JAC=1, IID=2
ICP=[1, 11], SP=['BP0', 'PD0', 'TR0'], NTST={intervals}, NCOL={points}, IAD={adapted}
THL={{11: 0.0}}, THU={{{no_states}}}
NMX={most}, NPR={most}, ITMX=20, ITNW=20, NWTN=1, EPSL={tolerance!r}, EPSU={tolerance!r}, EPSS=1e-5
DS={step!r}, DSMIN={step!r}, DSMAX={step!r}, IADS=0
"""
"""Content of AUTO's constants file for a continuation in F, a format of `str.format`.

The step length counts F only. AUTO computes all Floquet multipliers, but locates no bifurcations, because
locating them would take further cycles. AUTO assembles one Jacobian per cycle, at the predictor; the
multipliers belong to this Jacobian."""


@dataclass(frozen=True, slots=True)
class AutoSetting:
    """Mesh and tolerance of a run of AUTO-07p.

    order: order of the single element in space. intervals: NTST, mesh intervals of a period. points: NCOL,
    collocation points of an interval. adapted: IAD, cycles between two mesh adaptations; 0 for a fixed mesh.
    tolerance: EPSL and EPSU, relative tolerance of Newton's method.
    """

    order: int
    intervals: int
    points: int
    adapted: int
    tolerance: float = 1e-7

    def __str__(self) -> str:
        return f"p = {self.order}, NTST = {self.intervals}, NCOL = {self.points}, IAD = {self.adapted}"


@dataclass(frozen=True, eq=False)
class AutoCycle:
    """Last cycle of a run of AUTO-07p, at the force F.

    period: in tau2. tip_y_max: largest y of the tip in L. multipliers: all Floquet multipliers, (unknowns,).
    """

    F: float
    period: float
    tip_y_max: float
    multipliers: Complex


def continue_cycles(program: Path, first: Orbit, setting: AutoSetting, step: float, cycles: int) -> AutoCycle:
    """Continues the cycle `first` in F by AUTO-07p, and returns the last of `cycles` cycles.

    step: difference of F between two cycles. Raises RuntimeError if AUTO fails.
    """
    unknowns = first.form.unknown_count
    constants = AUTO_CONSTANTS.format(
        unknowns=unknowns,
        intervals=setting.intervals,
        points=setting.points,
        adapted=setting.adapted,
        no_states=", ".join(f"{k}: 0.0" for k in range(1, unknowns + 1)),
        tolerance=setting.tolerance,
        most=cycles,
        step=step,
    )
    with tempfile.TemporaryDirectory(dir=program.parent) as directory:
        folder = Path(directory)
        (folder / "rod").write_bytes(rod_file(first.form))
        (folder / "start").write_bytes(start_file(first, setting.intervals * setting.points))
        said, lines = run_auto(program, folder, constants), table_lines(folder)
        if lines[-1][2] == NO_CONVERGENCE:
            raise RuntimeError(f"{AUTO} ends after {len(lines) - 1} of {cycles} cycles")
        F, period = map(float, re.findall(r"^at(.*)", said, re.MULTILINE)[-1].split())
        times, states = last_solution((folder / "fort.8").read_text())
        pairs = re.findall(r"Multiplier +\d+ +(\S+) +(\S+) ", (folder / "fort.9").read_text())
    multipliers = np.array([complex(*map(float, pair)) for pair in pairs[-unknowns:]])
    form = replace(first.form, rod=replace(first.form.rod, F=F))
    return AutoCycle(F, period, largest_y(form, period * times, states), multipliers)


def rod_file(form: StressForm) -> bytes:
    """Content of the file `rod`, from which AUTO's equations read the mesh in space and the parameters."""
    rod, matrices = form.rod, form.mesh.node_matrices
    numbers = np.array([rod.c1, rod.c2, rod.base_axial_drag, rod.base_rotational_drag])
    parts = (
        np.int32(form.mesh.node_count),
        matrices.transposed_differentiation_matrix,
        matrices.quadrature_weights,
        numbers,
    )
    return b"".join(part.tobytes() for part in parts)


def start_file(orbit: Orbit, pieces: int) -> bytes:
    """Content of the file `start`, from which AUTO's equations read the first cycle.

    The file has F, the period in tau2, and the states z at `pieces` + 1 equidistant times of one period, both
    ends included.
    """
    system, _ = system_and_state_on_cycle(orbit)
    turns = np.arange(pieces + 1) / pieces * orbit.symmetry.solved_parts_per_period
    states = orbit.states_at_time_fractions(np.where(turns > 1, turns - 1, turns))
    states[turns > 1] = orbit.symmetry.apply(states[turns > 1], orbit.form.layout)
    z = states * system.sqrt_compliance[:, :-1].ravel()
    return b"".join(part.tobytes() for part in (np.int32(pieces), np.array([system.rod.F, orbit.period]), z))


def last_solution(fort8: str) -> tuple[Array, Array]:
    """(times in periods, (NTST + 1,); states z, (NTST + 1, unknowns)) at the mesh points of the last cycle.

    fort8: text of AUTO's solution file fort.8.
    """
    lines, line_number = fort8.splitlines(), 0
    times: Array = np.empty(0)
    states: Array = np.empty((0, 0))
    while line_number < len(lines):
        head = list(map(int, lines[line_number].split()))
        count, width, rows, points = head[6], head[7], head[8], head[10]
        numbers = np.array(
            " ".join(lines[line_number + 1 : line_number + 1 + rows]).split()[: count * width], float
        )
        values = numbers.reshape(count, width)[::points]
        times, states = values[:, 0], values[:, 1:]
        line_number += rows + 1
    return times, states


def largest_y(form: StressForm, times: Array, states: Array) -> float:
    """Largest y of the tip, in L, on a cycle.

    times: in tau2, (m,). states: z, (m, unknowns); the last state repeats the first.
    """
    system = ExplicitSystem(form.rod, form.mesh)
    twice = np.concatenate([times, times[-1] + times[1:]]), np.concatenate([states, states[1:]])
    y = system.tip_coordinates(twice[1])[1]
    return tip_y_max_near_step(system, Trajectory(EndReason.reached, *twice), 1 + int(np.argmax(y[1:-1])))
