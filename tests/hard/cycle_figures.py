"""Figures of limit cycles and their branches, against the file and against far more accurate ones."""

import functools
import re
from dataclasses import replace
from math import floor, log10

import numpy as np
from matplotlib.collections import Collection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.quiver import Quiver

import rodsweep as rs
from rodsweep.discretization.elements.trigonometric import interpolate_samples
from rodsweep.model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES
from rodsweep.model.rod import Rod
from rodsweep.post.branch_curves import RodBranches

from .arm_sentences import UNIT, UNITS_AND_EXAMPLES, in_si
from .drawing import (
    LINE,
    PARAMETERS,
    SAME,
    cells,
    chosen,
    colour_of,
    nearly,
    one_of,
    parameters_told,
    plain,
    rods_of_line,
    told,
    unit_factor,
    words_of,
    xy,
)
from .page import read, unit_of
from .truths import changes_on_lines, leading, rods_of


def of_cycles(view, label, name=None):
    """What a label of a figure of cycles names, at every point in its unit; straight rods have the size 0."""
    v, words = {n: np.asarray(view.variables[n]).ravel() for n in CYCLE_NUMBERS}, words_of(view)
    name = name or next(key for start, key in LABELS_OF_CYCLES.items() if label.startswith(start))
    values = (v["tip_x_max"] - v["tip_x_min"]) / 2 if name == "reach" else v[name]
    values = np.where(np.isin(words, ("cycle", "unstable")), values, np.nan)
    if name in ("reach", "tip_y_max"):
        values = np.where(words == "straight", 0.0, values)
    return values * unit_at_points(view, "length" if name in ("reach", "tip_y_max") else name, label)


CYCLE_NUMBERS = ("tip_x_max", "tip_x_min", "tip_y_max", "period", "injection_mean")
LABELS_OF_CYCLES = {
    "tip (x": "reach",
    "tip y": "tip_y_max",
    "period": "period",
    "mean power": "injection_mean",
}


def unit_at_points(view, name, label):
    """The unit of a number of cycles in that of a label, at every point."""
    factor = unit_factor(label)
    if factor is None:
        return np.ones(view.variables["status"].size)
    scales = in_si(view)
    scales |= {"energy": scales["force_scale"] * scales["length"], "period": scales["tau2"]}
    scales |= {"injection_mean": scales["energy"] / scales["tau2"]}
    return scales[name] / factor


def cycle_figure(d, view, fine):
    labels = [d.label(axes, "y") for axes in d.panels]
    if any(isinstance(mark, QuadMesh) for mark in d.left):
        found = _cycle_maps(d, view)
    elif any(label.startswith("mean power") for label in labels):
        found = _amplitudes(d, view, fine)
    else:
        found = _of_cycles(d, view, fine)
    return found + parameters_told(d, view.point_columns)


def _amplitudes(d, view, fine):
    """Amplitudes, periods and powers over a parameter, with Hopf points and the square-root law."""
    columns, words, found = view.point_columns, words_of(view), []
    x = next(PARAMETERS[d.label(axes, "x")] for axes in d.panels if d.label(axes, "x"))
    hopf = {"F**": [], "restabilization": []}
    for _, c, _ in changes_on_lines(view, "F") if x == "F" else ():
        if c.kind.name != "onset":
            hopf["F**" if c.kind.name == "hopf" else "restabilization"].append(c.value)
    low, high = columns[x].min(), columns[x].max()
    hopf = {word: [at for at in places if low <= at <= high] for word, places in hopf.items()}
    for axes in d.panels:
        label = d.label(axes, "y")
        values, laws = of_cycles(view, label), []
        d.zeros(axes)
        every = sum(hopf.values(), [])
        marked = [at for at, _ in d.verticals(axes)]
        found.append(
            (label, d.compare(axes, (marked, np.zeros(len(marked))), (every, np.zeros(len(every))), SAME))
        )
        lost = d.take(axes, Line2D, lambda one: one.get_marker() == "x")
        gone = columns[x][~np.isin(words, ("cycle", "unstable", "straight", "missing"))]
        right = sorted(float(x) for one in lost for x in one.get_xdata()) == sorted(gone.tolist())
        found.append((label, "" if right else f"marks at the top are not the {len(gone)} points"))
        open_ = d.lines(
            axes, lambda one: to_hex(one.get_markerfacecolor()) == "#ffffff" and one.get_marker() != "None"
        )
        unstable = words == "unstable"
        found.append((label, d.compare(axes, xy(open_), (columns[x][unstable], values[unstable]))))
        laws = d.lines(axes, lambda one: one.get_marker() == "None")
        for line in laws:
            found.append((label, _law(d, axes, line, view, fine, every)))
        for line in d.lines(axes):
            here = rods_of_line(line, d.legend_entries(), columns) & np.isfinite(values)
            found.append((label, d.compare(axes, xy([line]), (columns[x][here], values[here]))))
    for word, places in hopf.items():
        symbol = re.escape(word)
        for line, match in read(d.page, rf"^{symbol}(?: at F)? = NUMBER$"):
            found.append((line, one_of(match[1], places)))
    for line, match in read(d.page, r"sqrt\(.*, a = NUMBER(?:(?:,| to) NUMBER)?(?:, NUMBER)?"):
        true = _normal_form_sizes(view)
        why = (one_of_rough(text, true, view) for text in match.groups() if text)
        found.append((line, "; ".join(filter(None, why))))
    return found


@functools.cache
def _sizes_of_rod(rod, gamma1, top):
    data = rs.sweep(
        "criticality", k1=rod.k1, k2=rod.k2, gamma3=rod.gamma3, gamma1=gamma1, F_max=top, progress=False
    )
    return np.abs(data.amplitude_coefficient.values.ravel())


def _normal_form_sizes(view):
    """|a| of every Hopf point of the rods of a file, in the unit of its figure's lengths."""
    found = []
    for i, rod in enumerate(rods_of(view)):
        top = min(float(view.point_columns["F"].max()), 0.999 * rod.k1)
        sizes = _sizes_of_rod(replace(rod, F=0.0), float(view.point_columns["gamma1"][i]), top)
        scale = (
            in_si(view)["length"][i] / UNITS_AND_EXAMPLES[view.typed_units.get("length", "m")]
            if view.quantities
            else 1.0
        )
        found += (sizes[np.isfinite(sizes)] * scale).tolist()
    return np.array(found)


def one_of_rough(text, true, view):
    """Why a coefficient is none of true ones, to the digits that are written."""
    near = min(true, key=lambda a: abs(a - float(text)), default=np.nan)
    return "" if abs(near - float(text)) <= 0.5 * unit_of(text) * (1 + 1e-6) else f"a = {text} is {near!r}"


def _law(d, axes, line, view, fine, hopf):
    """Why the curve of a square-root law is none beside a Hopf point."""
    x, y = xy([line])
    near = min(hopf, key=lambda at: abs(at - x[0]), default=np.nan)
    a = y[-1] / np.sqrt(abs(x[-1] / near - 1))
    return d.compare(axes, (x, y), (x, a * np.sqrt(np.abs(x / near - 1))), LINE)


def _cycle_maps(d, view):
    """Period and size over two parameters, what else became of rods, and the line of Hopf points."""
    columns, words, found = view.point_columns, words_of(view), []
    fills = {
        text: to_hex(handle.get_facecolor())
        for handle, text in d.legend_entries()
        if isinstance(handle, Patch)
    }
    for axes in d.panels:
        x, y = (PARAMETERS[d.label(axes, which)] for which in "xy")
        at = columns[x], columns[y]
        (mesh,) = d.take(axes, QuadMesh)
        label = next(
            plain(a.get_ylabel())
            for a in d.figure.axes
            if getattr(a, "_colorbar", None) and a._colorbar.mappable is mesh
        )
        values = np.where(np.isin(words, ("cycle", "unstable")), of_cycles(view, label), np.nan)
        found.append((label, cells(d, axes, mesh, at, values)))
        open_ = d.lines(axes, lambda one: one.get_marker() == "o")
        found.append((label, d.compare(axes, xy(open_), [c[words == "unstable"] for c in at])))
        covers = d.take(axes, Collection)
        for place, word in zip(zip(*at, strict=True), words, strict=True):
            d.marks += 1
            over = {
                colour_of(each)
                for each in covers
                if any(path.contains_point(place) for path in each.get_paths())
            }
            right = set() if word in ("cycle", "unstable") else {fills.get(word.replace("_", " "))}
            found.append(
                (
                    label,
                    "" if over == right or not np.isfinite(place).all() else f"{word} at {place} is {over}",
                )
            )
        for line in d.lines(axes):
            found.append((label, _on_hopf_rows(d, axes, xy([line]), view, x, y)))
    return found


def _on_hopf_rows(d, axes, vertices, view, x, y):
    """Why vertices of the line of Hopf points that lie on a row of the file are no Hopf points."""
    columns, shared = view.point_columns, {n: float(c[0]) for n, c in view.point_columns.items()}
    d.marks += len(vertices[0])
    for value in np.unique(columns[y]):
        on = np.isclose(vertices[1], value, rtol=1e-9)
        rod = Rod(**{n: (shared | {y: float(value)})[n] for n in NON_OPTIONAL_LINEAR_PARAMETER_NAMES})
        low, high = float(columns[x].min()), float(columns[x].max())
        for at in vertices[0][on]:
            rate = (
                [leading(replace(rod, **{x: float(at) * (1 + s * 1e-4)}))[0].real for s in (-1, 1)]
                if x != "gamma1"
                else [-1, 1]
            )
            if not (low <= at <= high and np.sign(rate[0]) != np.sign(rate[1])):
                return f"growth rates beside {x} = {at}, {y} = {value} are {rate}"
    return ""


def _of_cycles(d, view, fine):
    """Shapes, the tip in time, energies or transients of some points, a column each."""
    found, columns = [], {}
    for axes in d.panels:
        columns.setdefault(
            axes.get_subplotspec().colspan.start
            if len(d.panels) != 3 or len({a.get_subplotspec().colspan.start for a in d.panels}) != 2
            else 0,
            [],
        ).append(axes)
    words = words_of(view)
    transient = not any(isinstance(mark, Quiver) for mark in d.left) and "energy" not in d.label(
        d.panels[0], "y"
    )
    there = np.isfinite(view.variables["transient_time"][..., -1].ravel()) if transient else words == "cycle"
    for point, panels in zip(np.flatnonzero(there), columns.values(), strict=False):
        cycle = _Cycle(view, fine(), int(point))
        found += _titles_of_cycle(d, panels[0], cycle)
        for axes in panels:
            found += cycle.panel(d, axes)
    found += [(line, "") for line, _ in read(d.page, r"the first NUMBER of NUMBER \w+")]
    return found


def _titles_of_cycle(d, axes, cycle):
    """Period, power and imbalance above a column."""
    found, title = [], d.title(axes)
    for line in d.page:
        if line not in title or not line:
            continue
        for _, match in read(d.page, rf"T ?= NUMBER ({UNIT}|tau2)", only=line):
            unit = 1.0 if match[2] == "tau2" else cycle.scale("tau2") / UNITS_AND_EXAMPLES[match[2]]
            found.append((line, cycle.number(match[1], "period", unit, 4 if unit != 1 else 6)))
        for _, match in read(d.page, r"(?:^|[^T]) = NUMBER tau1", only=line):
            tau1 = cycle.columns["gamma3"] / cycle.columns["k2"]
            found.append((line, cycle.number(match[1], "period", 1 / tau1)))
        for _, match in read(d.page, rf"mean power NUMBER(?: ({UNIT}))?", only=line):
            power = cycle.scale("force_scale") * cycle.scale("length") / cycle.scale("tau2")
            found.append(
                (
                    line,
                    cycle.number(
                        match[1], "injection_mean", power / UNITS_AND_EXAMPLES[match[2]] if match[2] else 1.0
                    ),
                )
            )
        for _, match in read(d.page, r"imbalance NUMBER", only=line):
            found.append((line, nearly(match[1], float(cycle.own["energy_imbalance"]), 2)))
    return found


class _Cycle:
    """A point of a file, and the same far more accurate."""

    def __init__(self, view, fine, point):
        self.view, self.point = view, point
        self.own, self.fine = (self._at(each) for each in (view, fine))
        self.columns = {name: float(values[point]) for name, values in view.point_columns.items()}
        self.word = words_of(view)[point]

    def _at(self, view):
        shape = view.variables["status"].shape
        some = {n: np.asarray(view.variables[n]) for n in view.variables}
        return {
            n: x.reshape(-1, *x.shape[len(shape) :])[self.point]
            for n, x in some.items()
            if x.shape[: len(shape)] == shape
        }

    def scale(self, name):
        return float(in_si(self.view)[name][self.point]) if self.view.quantities else 1.0

    def number(self, text, name, unit, digits=6):
        """Why a text is not the true number to the last digit that its error leaves."""
        true, stored = float(self.fine[name]) * unit, float(self.own[name]) * unit
        slack = abs(stored - true) if digits == 4 else 0.0
        off = abs(float(text) - true)
        return (
            ""
            if off <= max(unit_of(text), 10.0 ** (floor(log10(abs(true))) - 5)) + slack
            else f"{text} is {true!r}"
        )

    def unit(self, label, of):
        """The unit of a label in those of the rod, for a number of a kind."""
        factor = unit_factor(label)
        if factor is None:
            return 1.0
        energy = self.scale("force_scale") * self.scale("length")
        return {
            "length": self.scale("length"),
            "time": self.scale("tau2"),
            "energy": energy,
            "power": energy / self.scale("tau2"),
        }[of] / factor

    def panel(self, d, axes):
        """The check of all lines of a panel."""
        x, y = d.label(axes, "x"), d.label(axes, "y")
        if x.startswith("x"):
            return self._shapes(d, axes, self.unit(x, "length"))
        time = self.unit(x, "time")
        period, found = float(self.own["period"]) * time, []
        at = [at for at, _ in d.verticals(axes)]
        low = axes.get_ylim()[0]
        found.append((y, d.compare(axes, (at, low), ([period] * len(at), low))))
        d.zeros(axes)
        of = {
            "tip x": ["tip_x"],
            "tip y": ["tip_y"],
            "energy": ["energy"],
            "power": ["injection", "dissipation"],
        }
        kind = next((k for k in of if y.startswith(k)), "rate")
        levels = d.take(axes, Line2D, lambda one: one.get_transform() == axes.get_yaxis_transform())
        if levels:
            names = {
                "power": [("injection_mean", 1)],
                "tip x": [("tip_x_min", 1), ("tip_x_max", 1)],
                "tip y": [("tip_y_max", 1), ("tip_y_max", -1)],
            }[kind]
            unit = self.unit(y, "power" if kind == "power" else "length")
            true = [sign * float(self.own[name]) * unit for name, sign in names]
            drawn = [float(line.get_ydata()[0]) for line in levels]
            found.append(
                (
                    y,
                    d.compare(
                        axes, (np.full(len(drawn), period / 2), drawn), (np.full(len(true), period / 2), true)
                    ),
                )
            )
        for line in d.lines(axes):
            found.append((y, self._curve(d, axes, line, kind, time, y)))
        return found

    def _curve(self, d, axes, line, kind, time, y):
        """Why a curve or marks over time are not those of the finer cycle, or the stored transient."""
        t, values = xy([line])
        names = {"tip x": "tip_x", "tip y": "tip_y", "energy": "energy", "power": line.get_label()}
        of = {"energy": "energy", "power": "power", "rate": "power"}.get(kind, "length")
        unit, period = self.unit(y, of), float(self.own["period"]) * time
        if (
            kind.startswith("tip")
            and "transient_time" in self.own
            and np.isfinite(self.own["transient_time"]).all()
        ):
            true = self.own["transient_time"] * time, self.own[names[kind].replace("tip", "transient")] * unit
            return d.compare(axes, (t, values), true)
        phase = (t / period) % 1.0
        if kind == "rate":
            true = interpolate_samples(self.fine["injection"] - self.fine["dissipation"], phase)
            error = self.error("injection")
        else:
            name = names[kind] if names[kind] in self.fine else names[kind].replace("tip", "shape")
            samples = self.fine[name] if self.fine[name].ndim == 1 else self.fine[name][:, -1]
            true, error = interpolate_samples(samples, phase), self.error(name)
        height = np.ptp(axes.get_ylim())
        return d.compare(axes, (t, values), (t, true * unit), LINE + error * unit / height, whole=False)

    def error(self, name):
        """By how much the samples of the file are off those of the finer cycle."""
        return float(np.abs(self.own[name] - self.fine[name]).max())

    def _shapes(self, d, axes, length):
        """Shapes through the cycle, the path of the tip, the wall, and the force at the tip."""
        arrows, found = d.take(axes, Quiver), []
        d.take(axes, Patch), d.take(axes, Line2D, lambda one: one.get_linewidth() == 1.4)
        shapes = d.lines(axes, lambda one: one.get_linewidth() == 1.8)
        x, y, theta = (self.own[f"shape_{name}"] for name in ("x", "y", "theta"))
        stride = len(x) // len(shapes) if len(x) % len(shapes) == 0 else -(-len(x) // len(shapes))
        for k, (line, arrow) in enumerate(zip(shapes, arrows, strict=True)):
            i = k * stride
            found.append((f"shape {k}", d.compare(axes, xy([line]), (x[i] * length, y[i] * length))))
            tip = [(x[i, -1] * length, y[i, -1] * length)]
            along = np.array([float(arrow.U[0]), float(arrow.V[0])])
            e1 = np.array([np.cos(theta[i, -1]), np.sin(theta[i, -1])])
            right = np.allclose(arrow.XY, tip) and np.allclose(along / np.hypot(*along), -e1)
            found.append((f"arrow {k}", "" if right else f"{arrow.XY}, {along} is {tip}, {-e1}"))
            d.marks += 1
        tips = (
            [self.own[n] * length for n in ("tip_x", "tip_y")]
            if "tip_x" in self.own
            else [x[:, -1] * length, y[:, -1] * length]
        )
        phase = np.linspace(0, 1, 401)
        path = [interpolate_samples(values, phase) for values in tips]
        return [*found, ("path of the tip", d.compare(axes, xy(d.lines(axes)), path))]


BRANCH_WORDS = {
    "Hopf point": "hopf",
    "fold": "fold",
    "torus point": "torus",
    "symmetry breaking": "symmetry_breaking",
    "period doubling": "period_doubling",
    "section crushed (h1 = 0)": "left_the_model",
    "not followed further": "no_cycle_found",
    "last stored cycle": "list_full",
}
STYLE_OF_STABILITY = {"-": 1, "--": 0, ":": -1}


def branch_figure(d, view, fine):
    columns, found = view.point_columns, []
    entries = d.legend_entries()
    own = {rod: RodBranches(view, rod).curves for rod in range(view.variables["status"].size)}
    true = {rod: RodBranches(fine(), rod).curves for rod in own}
    upper, lower, *third = d.panels
    rods = [rod for rod in own if any(curve.is_cycle.any() for curve in own[rod])]
    colours = {colour_of(handle): told(text) for handle, text in entries if told(text)}
    straight = upper and d.lines(
        upper, lambda one: colour_of(one) == "#000000" and one.get_marker() == "None"
    )
    found += [("straight rod", _straight(d, upper, line, view, rods[0])) for line in straight]
    for axes, name in ((upper, "tip_y_max"), (lower, "period")):
        for mark, text in entries:
            if text in BRANCH_WORDS:
                marks = d.lines(
                    axes,
                    lambda one, mark=mark: (
                        one.get_marker() == mark.get_marker() and one.get_linestyle() == "None"
                    ),
                )
                of_kind = [
                    s
                    for each in own.values()
                    for curve in each
                    for s in curve.special_points
                    if BRANCH_WORDS[text] in (s.kind, s.reason)
                ]
                values = [s.tip_y_max if name == "tip_y_max" else s.period for s in of_kind]
                found.append((text, d.compare(axes, xy(marks), ([s.at for s in of_kind], values))))
        every = d.lines(axes)
        found.append((name, _smooth(d, axes, every, [c for rod in rods for c in true[rod]], name)))
        stored = [c for rod in rods for c in own[rod]]
        xs, ys = (np.concatenate([getattr(c, n) for c in stored]) for n in ("parameter", name))
        found.append((name, d.compare(axes, (xs, ys), xy(every), 1e-4, whole=False)))
        found += [(name, _stable(d, line, own, rods, colours, columns, view)) for line in every]
    for axes in third:
        law = d.lines(axes, lambda one: one.get_label() == "predicted by the normal form")
        x, y = xy(law)
        found.append(("normal form", d.compare(axes, (x, y), (x, np.sqrt(x)), LINE)))
        beside = [piece for rod in rods for c in own[rod] for piece in _beside(c)]
        found.append(
            ("beside Hopf points", d.compare(axes, xy(d.lines(axes)), np.concatenate(beside, axis=1)))
        )
    found += [
        (line, "")
        for line, _ in read(
            d.page,
            r"NUMBER branch(?:es)? of cycles over|NUMBER (?:more have|of NUMBER rods?)"
            "|of the first NUMBER of NUMBER rods",
        )
    ]
    read(d.page, r"F\^H - NUMBER\|")
    read(d.page, r"\(h1 = NUMBER\)")
    return found + parameters_told(d, columns)


def _beside(curve):
    """(|at/at_H - 1|, y/|a|) of the cycles beside the Hopf points at both ends, until they turn back."""
    for special, order in ((curve.special_points[0], 1), (curve.special_points[-1], -1)):
        a, at, y = special.amplitude_coefficient, curve.parameter[::order], curve.tip_y_max[::order]
        if special.kind != "hopf" or y[0] != 0 or not np.isfinite(a) or a == 0:
            continue
        away = np.sign(a) * (at / special.at - 1)
        end = next((i for i in range(1, len(away)) if away[i] <= away[i - 1]), len(away))
        if end > 2:
            yield np.array([away[1:end], y[1:end] / abs(a)])


def _straight(d, axes, line, view, rod):
    """Why the straight rod is not as stable as its line says, in the middle of it and inside of its ends."""
    columns, (low, high) = view.point_columns, line.get_xdata()
    stable = line.get_linestyle() == "-"
    name = next(n for n in NON_OPTIONAL_LINEAR_PARAMETER_NAMES if f"branch_{n}" in view.variables)
    d.marks += 1
    for share in (0.001, 0.5, 0.999):
        values = {n: float(columns[n][rod]) for n in NON_OPTIONAL_LINEAR_PARAMETER_NAMES if n in columns} | {
            name: low + share * (high - low)
        }
        rate = leading(Rod(**values))[0].real
        if (rate < 0) != stable:
            return f"the growth rate at {values[name]} is {rate}"
    return ""


def _smooth(d, axes, lines, curves, name):
    """Why cycles of finer branches lie beside the curves that are drawn."""
    drawn = []
    for line in lines:
        at = d.places(axes, *xy([line]))
        drawn += zip(at[:-1], at[1:], strict=True)
    begins, ends = (np.array(some) for some in zip(*drawn, strict=True))
    worst, where = 0.0, None
    for curve in curves:
        some = curve.is_cycle
        places = d.places(axes, curve.parameter[some], getattr(curve, name)[some])
        inside = (np.abs(places - 0.5) <= 0.5).all(axis=1)
        off = np.array([_beside_pieces(begins, ends, place) for place in places])
        if len(off) and (off * inside).max() > worst:
            worst, where = (off * inside).max(), float(curve.parameter[some][np.argmax(off * inside)])
    return "" if worst <= LINE else f"a cycle at {where} lies {worst:.2g} beside the curve"


def _beside_pieces(begins, ends, place):
    """The distance of a place from the nearest of straight pieces, (n, 2) from, (n, 2) to."""
    sides = ends - begins
    lengths = np.maximum((sides**2).sum(axis=1), np.finfo(float).tiny)
    share = np.clip(((place - begins) * sides).sum(axis=1) / lengths, 0, 1)
    return np.linalg.norm(place - begins - share[:, None] * sides, axis=1).min()


def _stable(d, line, own, rods, colours, columns, view):
    """Why a piece of a branch has the line of another stability than the stored cycles along it."""
    x, y = xy([line])
    d.marks += 1
    of = colours.get(colour_of(line))
    here = chosen(columns, of) if of else np.ones(len(columns["k1"]), bool)
    said = STYLE_OF_STABILITY[line.get_linestyle()]
    for rod in rods:
        for curve in own[rod] if here[rod] else ():
            for i in np.flatnonzero(curve.is_cycle):
                on = np.hypot(x - curve.parameter[i], y - curve.tip_y_max[i])[1:-1]
                if len(on) and on.min() == 0:
                    beside = set(curve.stability[max(i - 1, 0) : i + 1].tolist())
                    if said not in beside:
                        return f"stability at {curve.parameter[i]} is {beside}, not {said}"
    return ""
