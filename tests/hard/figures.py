"""Figures of random sweeps and arms, every text and every mark of them read and held against true ones."""

import functools
from pathlib import Path

import numpy as np

import rodsweep as rs
from rodsweep.api.dataset import view_of_dataset
from rodsweep.errors import InputError
from rodsweep.model.arm.neglected import Validity
from rodsweep.post.figures import draw
from rodsweep.post.figures.request import FigureLook

from .arm_figures import arm_figure, quantities_told
from .arm_sentences import force_unit, in_si
from .cycle_figures import branch_figure, cycle_figure
from .drawing import Drawing, plain, ticks, unit_factor
from .page import read
from .sentences import FINE, random_sweep, solved
from .straight_figures import (
    criticality_figure,
    diagram_figure,
    modes_figure,
    spectrum_figure,
    thresholds_figure,
)


def second_scales(d, view):
    """The check of scales opposite to an axis: pressures of forces, times in tau1, Poisson's ratios of k2."""
    found = []
    for axes in d.figure.axes:
        for second in axes.child_axes:
            which = "x" if second.get_xlabel() else "y"
            label = plain(getattr(second, f"get_{which}label")())
            first = np.array(getattr(axes, f"get_{which}lim")())
            shown = np.array(getattr(second, f"get_{which}lim")())
            if not label:
                continue
            if label == "Poisson's ratio":
                axis = getattr(second, f"{which}axis")
                ratios = [float(plain(text.get_text())) for text in axis.get_majorticklabels()]
                known = np.argsort(np.ravel(view.variables["poisson"]))
                k2 = np.interp(ratios, *(np.ravel(view.variables[n])[known] for n in ("poisson", "k2")))
                right = np.allclose(axis.get_majorticklocs(), k2, rtol=2e-2)
            elif label.endswith("tau1"):
                tau1 = view.point_columns["gamma3"] / view.point_columns["k2"]
                right = np.isclose(shown[1] / first[1], 1 / tau1, rtol=1e-6).any()
            else:
                scale = in_si(view)[force_unit(view)] / unit_factor(label)
                right = np.allclose(shown, first * scale[0], rtol=1e-6)
            found.append((label, "" if right else f"{shown} is not {first} in its unit"))
    return found


def validity_told(d, view):
    """The check of hatches and words where the model does not apply to an arm, in figures of rods."""
    found = []
    word = r"the model (does not apply|is doubtful)(?: at NUMBER of NUMBER points)?"
    for line, match in read(d.page, word):
        worst = Validity.doubtful if match.group(1) == "is doubtful" else Validity.does_not_apply
        outside = np.ravel(view.variables["model_applies"]) == worst
        numbers = [int(text) for text in match.groups()[1:] if text]
        right = numbers == [outside.sum(), outside.size] if numbers else outside.any()
        found.append((line, "" if right else f"it is {outside.sum()} of {outside.size}"))
    if any(": the model " in line for line in d.page):
        d.left = {mark: of for mark, of in d.left.items() if not getattr(mark, "get_hatch", lambda: "")()}
    return found


CHECKS = {
    "spectrum": spectrum_figure,
    "modes": modes_figure,
    "thresholds": thresholds_figure,
    "criticality": criticality_figure,
    "limit_cycle": cycle_figure,
    "phase_diagram": diagram_figure,
    "branch": branch_figure,
}
COLUMN_WIDTHS = (None, "89 mm", "183 mm")


def random_figure(index):
    """(task, keywords of `rs.sweep`, choices and the width of `rodsweep plot`) of that number."""
    random = np.random.default_rng([36, index])
    task, keywords = random_sweep(index)
    choices, width = {}, COLUMN_WIDTHS[int(random.integers(3))]
    if "arm" in keywords:
        if task in ("thresholds", "spectrum", "modes") and random.random() < 0.5:
            _second_quantity(random, keywords["arm"])
        return task, keywords, choices, width
    top = np.max(keywords.get("F", keywords.get("F_max", 60.0))) if task != "phase_diagram" else 0
    change = _CHANGES.get(task, lambda random, keywords, top: (keywords, {}))
    return task, *change(random, dict(keywords), float(top)), width


def _second_quantity(random, arm):
    """Let one more quantity of an arm take several values."""
    name = str(random.choice([n for n in ("length", "young", "viscosity") if not isinstance(arm[n], list)]))
    value, unit = arm[name].split(" ", 1)
    arm[name] = [f"{float(value) * (1 + 0.12 * k):.6g} {unit}" for k in range(3)]


def _over_two(random, keywords, names, counts):
    """Keywords whose parameters of these names take so many values, in ratios."""
    for name, count in zip(names, counts, strict=True):
        value = np.ravel(keywords[name])[0]
        low = {"k1": 120.0, "k2": 10.0, "gamma3": 1e-5, "F": 0.0}[name]
        keywords[name] = (
            np.linspace(0, value, count)
            if name == "F"
            else low * 10 ** np.linspace(0, random.uniform(1, 3), count)
        ).tolist()
    return keywords


def _single(keywords):
    """Keywords in which every parameter but F has one finite value."""
    one = {"k1": 300.0, "k2": 1e3, "gamma3": 1e-3}
    values = {n: float(np.ravel(keywords[n])[0]) for n in one}
    return keywords | {n: x if np.isfinite(x) else one[n] for n, x in values.items()}


def _spectra(random, keywords, top):
    kind = random.choice(["as it is", "line", "line", "panels", "map"])
    keywords["modes"] = int(random.integers(1, 7))
    if kind == "as it is":
        return keywords, {}
    keywords = _single(keywords)
    # A pull is a negative force: the forces rise from it to 0.
    keywords["F"] = sorted(
        np.linspace(0, min(top, 0.9 * keywords["k1"]), int(random.integers(6, 30))).tolist()
    )
    if kind == "line":
        return keywords, {"roots": random.choice([None, "rightmost", "smallest", "all"])}
    name = str(random.choice(["k2", "gamma3"]))
    return _over_two(random, keywords, [name], [int(random.integers(2, 4)) if kind == "panels" else 8]), {}


def _forces(random, keywords, top):
    kind = random.choice(["as it is", "one", "few", "many"])
    names = [str(n) for n in random.choice(["k1", "k2", "gamma3"], 2, replace=False)]
    keywords |= {"F_max": top}
    if kind == "as it is":
        return keywords, {}
    counts = {"one": [9, 1], "few": [3, 7], "many": [7, 8]}[str(kind)]
    return _over_two(random, _single(keywords), names, counts), {
        "what": random.choice([None, "map", "lines"])
    } if kind == "many" else {}


def _sides(random, keywords, top):
    kind = random.choice(["as it is", "one", "map"])
    if kind == "as it is":
        return keywords, {}
    return _over_two(random, _single(keywords), ["k2", "gamma3"], [3, 2] if kind == "map" else [4, 1]), {}


def _beating(random, keywords):
    """Keywords with forces below and above the first Hopf point."""
    rod = {name: keywords[name] for name in ("k1", "k2", "gamma3")}
    rod |= {"k1": min(rod["k1"], 2e3), "k2": min(rod["k2"], 1e4), "gamma3": max(rod["gamma3"], 1e-5)}
    hopf = float(rs.Rod(**rod).thresholds(F_max=0.95 * rod["k1"]).F_hopf)
    F = (hopf * np.array([0.9, 1.03, 1.05, 1.09, 1.2]))[-int(random.integers(1, 6)) :]
    return keywords | rod | {"F": F.tolist()} if np.isfinite(hopf) else keywords


def _cycles(random, keywords, top):
    kind = str(random.choice(["amplitude", "cycle", "energy", "transient", "maps"]))
    keywords |= {"shapes": 12, "samples": 48}
    if kind != "maps":
        keywords = _beating(random, _single(keywords))
    if kind == "transient":
        keywords["transient"] = 40
    if kind == "maps":
        keywords = _single(keywords) | {"F": [0.4 * top, 0.7 * top, top]}
        keywords["k2"] = [keywords["k2"], 1.3 * keywords["k2"]]
    return keywords, {"what": kind}


_CHANGES = {"spectrum": _spectra, "thresholds": _forces, "criticality": _sides, "limit_cycle": _cycles}


def wrong_figure(task, keywords, choices, width):
    """(texts and marks that are wrong or that nothing reads, with why; counts, None without a figure)."""
    view = view_of_dataset(rs.sweep(task, progress=False, **keywords), Path(f"{task}.h5"))
    choices = {name: str(value) for name, value in choices.items() if value is not None}
    figures = []
    try:
        sentence = draw(
            view, Path("drawn.png"), look=FigureLook(width=width), figure_callback=figures.append, **choices
        )
    except InputError as refused:
        return (
            []
            if "that could be drawn" in str(refused) or "which needs" in str(refused)
            else [("refused", str(refused))]
        ), None
    d, listed = Drawing(figures[0], sentence), view.as_list
    fine = functools.cache(lambda: solved(task, keywords | {"accuracy": FINE[task]}))
    of_arms = view.arm_axes and not choices and task in ("thresholds", "spectrum", "modes", "limit_cycle")
    found = arm_figure(d, view, listed, fine) if of_arms else CHECKS[task](d, listed, fine)
    found += quantities_told(d, listed) + second_scales(d, listed) + validity_told(d, listed) + ticks(d)
    found += [("in the sentence", "") for _ in read(d.page, r"of NUMBER points? (?:NUMBER|are|failed)")]
    return [(what, why) for what, why in found if why] + d.unread(), d.count()
