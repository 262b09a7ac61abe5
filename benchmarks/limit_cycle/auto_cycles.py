"""AUTO-07p continuing the cycles of a rod in F, with their multipliers, on this tool's mesh in space.

It collocates at Gauss points over the whole period, starts from this tool's cycle, and takes equal steps. Its
largest y is measured as that of integrators, from its nodes in time, where collocation is most accurate.
"""

import re
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rodsweep.arrays import Array, Complex
from rodsweep.bench.limit_cycle.tracking import height_near, on_cycle
from rodsweep.discretization.beam import Beam
from rodsweep.discretization.stress.form import StressForm
from rodsweep.solve.motion.integrator import RunEnding, Trajectory
from rodsweep.solve.orbit.orbit import Orbit

from ..auto import AUTO, run_auto, table_lines

NO_CONVERGENCE = "-9"
"""Third word of a line of fort.7."""
CONSTANTS = """NDIM={unknowns}, IPS=2, IRS=0, ILP=0, ISP=2, ISW=1, MXBF=0, JAC=1, IID=2
ICP=[1, 11], SP=['BP0', 'PD0', 'TR0'], NTST={intervals}, NCOL={points}, IAD={adapted}
THL={{11: 0.0}}, THU={{{no_states}}}
NMX={most}, NPR={most}, ITMX=20, ITNW=20, NWTN=1, EPSL={tolerance!r}, EPSU={tolerance!r}, EPSS=1e-5
DS={step!r}, DSMIN={step!r}, DSMAX={step!r}, IADS=0
"""
"""Steps are in F alone. All multipliers are computed, but what happens to them is not looked for: it would
take further cycles. One matrix is made for each cycle, at its prediction; the multipliers are that one's."""


@dataclass(frozen=True, slots=True)
class AutoSetting:
    """order: of the one element in space; intervals NTST, points NCOL, a new mesh after `adapted` cycles."""

    order: int
    intervals: int
    points: int
    adapted: int
    tolerance: float = 1e-7

    def __str__(self) -> str:
        return f"p = {self.order}, NTST = {self.intervals}, NCOL = {self.points}, IAD = {self.adapted}"


@dataclass(frozen=True, eq=False)
class Branch:
    """AUTO's last cycle, at the force F: period in tau2, the tip's largest y in L, all multipliers."""

    F: float
    period: float
    tip_y_max: float
    multipliers: Complex


def continued(program: Path, first: Orbit, setting: AutoSetting, step: float, cycles: int) -> Branch:
    """So many cycles from the first, in steps of F; RuntimeError where AUTO fails."""
    unknowns = first.form.unknowns
    constants = CONSTANTS.format(
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
        place = Path(directory)
        (place / "rod").write_bytes(rod_file(first.form))
        (place / "start").write_bytes(start_file(first, setting.intervals * setting.points))
        said, lines = run_auto(program, place, constants), table_lines(place)
        if lines[-1][2] == NO_CONVERGENCE:
            raise RuntimeError(f"{AUTO} ends after {len(lines) - 1} of {cycles} cycles")
        F, period = map(float, re.findall(r"^at(.*)", said, re.MULTILINE)[-1].split())
        times, states = last_solution((place / "fort.8").read_text())
        pairs = re.findall(r"Multiplier +\d+ +(\S+) +(\S+) ", (place / "fort.9").read_text())
    multipliers = np.array([complex(*map(float, pair)) for pair in pairs[-unknowns:]])
    form = replace(first.form, rod=replace(first.form.rod, F=F))
    return Branch(F, period, largest_y(form, period * times, states), multipliers)


def rod_file(form: StressForm) -> bytes:
    """What the equations read as `rod`."""
    rod, matrices = form.rod, form.mesh.matrices
    numbers = np.array([rod.c1, rod.c2, rod.axial_drag, rod.rotational_drag])
    parts = (np.int32(form.mesh.nodes), matrices.D_transposed, matrices.weights, numbers)
    return b"".join(part.tobytes() for part in parts)


def start_file(orbit: Orbit, pieces: int) -> bytes:
    """What the equations read as `start`: F, the period and the states z at equal times, ends included."""
    beam, _ = on_cycle(orbit)
    turns = np.arange(pieces + 1) / pieces * orbit.symmetry.parts
    states = orbit.at(np.where(turns > 1, turns - 1, turns))
    states[turns > 1] = orbit.symmetry.of(states[turns > 1], orbit.form.layout)
    z = states * beam.sqrt_compliance[:, :-1].ravel()
    return b"".join(part.tobytes() for part in (np.int32(pieces), np.array([beam.rod.F, orbit.period]), z))


def last_solution(fort8: str) -> tuple[Array, Array]:
    """Times in periods, (NTST + 1,), and states, (NTST + 1, unknowns), at the nodes in time."""
    lines, place = fort8.splitlines(), 0
    times, states = np.empty(0), np.empty((0, 0))
    while place < len(lines):
        head = list(map(int, lines[place].split()))
        count, width, rows, points = head[6], head[7], head[8], head[10]
        numbers = np.array(" ".join(lines[place + 1 : place + 1 + rows]).split()[: count * width], float)
        values = numbers.reshape(count, width)[::points]
        times, states = values[:, 0], values[:, 1:]
        place += rows + 1
    return times, states


def largest_y(form: StressForm, times: Array, states: Array) -> float:
    """The tip's largest y in L on a cycle of states z, (m, n), at times, (m,), the first again at the end."""
    beam = Beam(form.rod, form.mesh)
    twice = np.concatenate([times, times[-1] + times[1:]]), np.concatenate([states, states[1:]])
    y = beam.tip(twice[1])[1]
    return height_near(beam, Trajectory(RunEnding.reached, *twice), 1 + int(np.argmax(y[1:-1])))
