"""Results of limit_cycle in closed form: a swinging arc with its energy."""

from pathlib import Path

import h5py
import numpy as np

from rodsweep.results.file.creation import FilePlan, create_file
from rodsweep.results.file.seal import seal
from rodsweep.results.file.view import ResultView
from rodsweep.results.layouts import layout_of
from rodsweep.results.layouts.limit_cycle import hopf_point_variables
from rodsweep.results.layouts.thresholds import CROSSING_KINDS
from rodsweep.sweep.points.points import Points

HOPF_POINTS = hopf_point_variables(("F", "k1", "k2", "gamma3"))
NAMES = ("F", "k1", "k2", "gamma3", "gamma1")
FLAGS = {-1: "missing", 0: "cycle", 1: "straight", 2: "not_settled", 3: "left_the_model", 4: "failed"}
UNSTABLE, TORUS = 5, 6
MORE_FLAGS = FLAGS | {UNSTABLE: "unstable", TORUS: "torus"}
PERIODS = {1.0: 0.034, 0.5: 0.026}
SAMPLES, SHAPES = 64, 12


def arm(phase, size):
    """(x, y, theta) of an arc of constant curvature that swings, shape (3, times, nodes), and u."""
    u = np.linspace(0, 1, 21)
    bend = size * np.cos(2 * np.pi * phase)[:, None] + 1e-9
    return np.array([np.sin(bend * u) / bend, (1 - np.cos(bend * u)) / bend, bend * u]), u


def energies(phase, period):
    """U, injection and dissipation with dU/dt = injection - dissipation."""
    a = 4 * np.pi * phase
    injection = 2000 + 500 * np.sin(a)
    return 3 + 0.3 * np.cos(a), injection, injection + 0.3 * np.sin(a) * 4 * np.pi / period


def growth_rate(above):
    """A smooth growth rate, by F - F**."""
    return 6.9 * above * np.exp(above / 60)


def make_view(axes, statuses, *, stored=("shapes", "samples"), name="fake.h5", as_list=False, hopf=None):
    """A result as the task writes it, whose amplitude depends on F and gamma1; axes in the order of NAMES.

    hopf gives F** from the five parameters, and the amplitude follows its law exactly; without it the rod has
    no Hopf point.
    """
    table = np.meshgrid(*axes, indexing="ij") if not as_list else [np.asarray(a, float) for a in axes]
    shape = table[0].shape
    status = np.array(statuses, "i1").reshape(shape)
    v = {n: np.asarray(a, float) for n, a in zip(NAMES, axes, strict=True)} | {"status": status}
    if as_list:
        v["point"] = np.arange(shape[0])
    size = np.sqrt(table[0]) / 8 / (1 + table[4])
    v |= {"linear_growth_rate": np.ones(shape), "linear_frequency": np.full(shape, 110.0)}
    v |= {"second_state": np.zeros(shape, "i1"), "subcritical_F": np.full(shape, np.nan)}
    if hopf:
        threshold = np.minimum(hopf(*table), 1e3)
        v["linear_growth_rate"] = growth_rate(table[0] - threshold)
        size = np.sqrt(np.clip(table[0] / threshold - 1, 0, None)) / (1 + table[4])
    v |= hopf_table(table, hopf)
    period = np.vectorize(lambda g: PERIODS.get(g, 0.03))(table[4])
    points = list(zip(size.ravel(), period.ravel(), strict=True))
    kept = np.where(np.isin(status, (0, UNSTABLE)), 1.0, np.nan)
    v |= {"period": period * kept, "tip_y_max": size * kept}
    v |= {"tip_x_min": (0.9 - size) * kept, "tip_x_max": (0.9 + size) * kept}
    v |= {"injection_mean": 2000 * kept, "energy_imbalance": 1e-9 * kept}
    v |= {"period_error": 1e-9 * kept, "amplitude_error": 1e-9 * kept, "extrema_error": 1e-9 * kept}
    v |= {"multiplier": 0.5 * kept}
    phase, few = np.arange(SAMPLES) / SAMPLES, np.arange(SHAPES) / SHAPES

    def fill(names, arrays):
        for i, key in enumerate(names):
            v[key] = np.array([a[i] for a in arrays]).reshape(*shape, *np.shape(arrays[0][i]))

    if "samples" in stored:
        fill(("energy", "injection", "dissipation"), [energies(phase, T) for _, T in points])
        fill(("tip_x", "tip_y", "tip_theta"), [arm(phase, s)[0][..., -1] for s, _ in points])
    if "shapes" in stored:
        fill(("shape_x", "shape_y", "shape_theta"), [arm(few, s)[0] for s, _ in points])
        v["u"] = arm(few, 1.0)[1]
    return ResultView(Path(name), {"task": "limit_cycle", "title": "two $ arms"}, v, NAMES, MORE_FLAGS, 0)


def hopf_table(table, hopf, error=1e-12):
    """The Hopf points along F of a view whose rods have one each, as the task stores them.

    table: the five parameters at every point; hopf: F** of them, or None where there is none.
    """
    rods = np.unique(np.stack([column.ravel() for column in table[1:4]], axis=-1), axis=0)
    gamma1 = float(table[4].ravel()[0])
    F = (
        np.array([hopf(*(np.asarray(value) for value in (1.0, *rod, gamma1))) for rod in rods])
        if hopf
        else []
    )
    return hopf_variables("F", [(float(at), *rod) for at, rod in zip(F, rods, strict=False)], error)


def hopf_variables(along, rods, error=1e-12, kinds=None):
    """The variables of Hopf points along a parameter; rods: F, k1, k2, gamma3 of each."""
    count = len(rods)
    kinds = kinds or ["hopf"] * count
    columns = np.array(rods, float).reshape(count, 4).T
    return {f"hopf_{name}": column for name, column in zip(NAMES[:4], columns, strict=True)} | {
        "hopf_along": np.full(count, NAMES.index(along), "i1"),
        "hopf_kind": np.array([CROSSING_KINDS.index(kind) for kind in kinds], "i1"),
        "hopf_error": np.full(count, error),
        "hopf_frequency": np.full(count, 110.0),
        "hopf_frequency_error": np.full(count, 1e-10),
        "hopf_unstable_after": np.array([2 if kind == "hopf" else 0 for kind in kinds], "i4"),
        "hopf_lines": np.array(1, "i4"),
        "hopf_lines_proved": np.array(1, "i4"),
    }


OPTIONS = {"harmonics": 8, "samples": SAMPLES, "shapes": SHAPES, "nodes": 21, "transient": 0, "time": "tau2"}


def store(view, path, **options):
    """Writes what a view holds into a file as the task lays it out; options are those of limit_cycle."""
    parameters = {name: {"values": np.unique(view.variables[name]).tolist()} for name in NAMES}
    parameters = parameters if view.is_grid else {"points": "points.csv"}
    config = {"task": "limit_cycle", "parameters": parameters, "limit_cycle": OPTIONS | options}
    flags = tuple(item for item in view.status_flags.items() if item[0] >= 0)
    layout = layout_of(config)
    columns = tuple(np.asarray(view.variables[name], float) for name in layout.parameters)
    points = Points(layout.parameters, columns, view.is_grid)
    stored = tuple((v, view.variables[v.name]) for v in HOPF_POINTS)
    attributes = {"task": "limit_cycle", "title": "arms"}
    create_file(path, FilePlan(points, layout, {}, lambda: stored, config, attributes, flags))
    with h5py.File(path, "r+") as file:
        for name in view.variables.keys() - {*NAMES, "point", *(v.name for v in HOPF_POINTS)}:
            file[name][...] = view.variables[name]
    seal(path)
