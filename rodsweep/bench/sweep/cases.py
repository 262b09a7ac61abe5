"""The sweeps that are timed: their configs, each in a directory of its own."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

CONFIG = "c.yaml"
SPECTRUM_CONFIG = """
task: spectrum
parameters:
  F: {{start: 0, stop: 90, num: {forces}}}
  k1: [200, .inf]
  k2: {{start: 100, stop: 1.0e4, num: {softnesses}, spacing: log}}
  gamma3: 1.0e-4
spectrum: {{modes: 2}}
"""
CYCLE_CONFIG = "task: limit_cycle\nparameters: {points: points.csv}\n"
HOPF_FORCE = 27.4271941267592812
"""F of the Hopf point of k1 = 1e4, k2 = 1e2, gamma3 = 1e-2."""


@dataclass(frozen=True, slots=True)
class SweepCase:
    """A sweep to be run: how many points it has, and where its config is.

    kind: what takes the place of the solver, see `rodsweep.bench.sweep.launch`. Of several directories each
    has a share of the points, which a command of its own runs at the same time as the others.
    """

    name: str
    points: int
    directories: tuple[Path, ...]
    kind: str


def spectrum_case(directory: Path, name: str, points: int, kind: str) -> SweepCase:
    """A grid of two k1 and of F and k2; 200 points or more are rounded down to hundreds."""
    forces = 50 if points >= 200 else 2
    softnesses = points // (2 * forces)
    directory.mkdir()
    (directory / CONFIG).write_text(SPECTRUM_CONFIG.format(forces=forces, softnesses=softnesses))
    return SweepCase(name, 2 * forces * softnesses, (directory,), kind)


def cycle_case(directory: Path, points: int, kind: str) -> SweepCase:
    """Limit cycles of very different cost, in an order that mixes them."""
    directory.mkdir()
    rows = [f"{F!r},1e4,1e2,1e-2,1" for F in uneven_forces(points).tolist()]
    (directory / "points.csv").write_text("\n".join(["F,k1,k2,gamma3,gamma1", *rows]) + "\n")
    (directory / CONFIG).write_text(CYCLE_CONFIG)
    return SweepCase("limit cycles", points, (directory,), kind)


def uneven_forces(count: int) -> np.ndarray:
    """Forces far below the Hopf point, just below it, just above it, and ordinary ones, shape (count,)."""
    below, close, above = count // 5, count // 6, count // 4
    forces = np.concatenate(
        [
            np.linspace(5, 27, below),
            HOPF_FORCE * (1 - np.geomspace(1e-6, 1e-2, close)),
            HOPF_FORCE * (1 + np.geomspace(1e-7, 1e-2, above)),
            np.linspace(28, 90, count - below - close - above),
        ]
    )
    return np.random.default_rng(1).permutation(forces)
