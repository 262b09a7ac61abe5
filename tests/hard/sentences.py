"""Sweeps of random rods, what `show` says of them, and the same numbers from the solvers.

Numbers are read from the sentences that `show` prints. With an error beside it a number must lie within it of
the true one; an end of a range within one unit of its last digit, half for its error, half for rounding.
True numbers of motions and normal forms are those of a far smaller accuracy asked for; those of spectra and
thresholds come from eigenvalues on both sides of a stated place, which share no code with the covering.
"""

import re
from dataclasses import replace
from math import inf, log10
from pathlib import Path

import numpy as np

import rodsweep as rs
from rodsweep.api.dataset import view_of
from rodsweep.determinant.parameter_path import Path as ParameterPath
from rodsweep.determinant.winding_number import count_right_of
from rodsweep.model.parameters import LINEAR_PARAMETERS
from rodsweep.model.rod import Rod
from rodsweep.post.hopf_points import lines_over
from rodsweep.post.summary import SUMMARIES
from rodsweep.solve.changes.along_path import transitions
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum

TASKS = ("spectrum", "modes", "thresholds", "criticality", "limit_cycle", "phase_diagram", "branch")
NUMBER = r"-?\d+(?:\.\d+)?(?:e[+-]\d+)?"
BESIDE = 1e-7
"""Relative distance from a stated threshold at which eigenvalues are computed on both its sides."""
EXACT = SpectrumRequest(2, 1e-11, True)
FINE = {"criticality": 1e-9, "limit_cycle": 1e-7, "modes": 1e-10, "branch": 1e-7}
"""Accuracy to which true numbers are computed, by task."""
TIE = 1e-12
"""Relative difference of two numbers that rounding sets apart."""


def random_sweep(index):
    """(task, keywords of `rs.sweep`) of that number, whatever others are asked for."""
    random = np.random.default_rng([31, index])
    task = TASKS[index % len(TASKS)]
    if task == "branch" and index % 3:  # a branch takes as long as ten of the others
        task = "limit_cycle"
    count = 1 if random.random() < 0.3 else int(random.integers(2, 4))
    varied = str(random.choice(["k1", "k2", "gamma3"]))
    rods = {name: (_drawn(random, name, count if name == varied else 1)) for name in ("k1", "k2", "gamma3")}
    keywords = {name: values if len(values) > 1 else values[0] for name, values in rods.items()}
    top = min(0.97 * min(rods["k1"]), 10 ** random.uniform(1.5, 2.4))
    if task in ("spectrum", "modes", "limit_cycle"):
        points = int(random.integers(2, 7 if task == "spectrum" else 5))
        keywords["F"] = np.sort(random.uniform(0.05 * top, top, points)).tolist()
        if random.random() < 0.15:  # a sweep along another parameter
            keywords |= {"F": keywords["F"][-1], "k2": np.sort(10 ** random.uniform(0.5, 5, 4)).tolist()}
    if task == "phase_diagram":
        other = {"start": 0.0, "stop": top, "num": int(random.integers(5, 60))}
        keywords |= {"F": other} | {varied: np.sort(_drawn(random, varied, 3)).tolist()}
    if task in ("limit_cycle", "criticality", "branch"):
        keywords["gamma1"] = float(random.uniform(0.5, 1))
    if task in ("thresholds", "criticality"):
        keywords["F_max"] = top
    if task == "branch":
        keywords |= {name: value[0] for name, value in rods.items()} | {"stop": top}
    if task in FINE:
        keywords["accuracy"] = float(10 ** random.uniform(-5, -3 if task == "branch" else -2))
    return task, keywords


def _drawn(random, name, count):
    """Sorted values of a parameter, in and out of its limit."""
    if name == "gamma3":
        values = [0.0 if random.random() < 0.15 else 10 ** random.uniform(-8, -0.5) for _ in range(count)]
    else:
        low = log10(70) if name == "k1" else 1.0
        values = [inf if random.random() < 0.1 else 10 ** random.uniform(low, 7) for _ in range(count)]
    return sorted(set(map(float, values)))


def told_of(task, keywords):
    """(the results as `show` sees them, what it says of them)."""
    view = view_of(rs.sweep(task, progress=False, **keywords), Path(f"{task}.h5"))
    return view, SUMMARIES[task](view, view.variables["status"] >= 0)


def wrong_sentences(task, keywords):
    """The sentences of a sweep with a wrong number, each with what is wrong; and how many were read."""
    view, told = told_of(task, keywords)
    sentences = [*told.answer, *told.trust, *told.details]
    found = CHECKS[task](view, sentences, keywords)
    return [(sentence, why) for sentence, why in found if why], len(found)


# --- numbers in sentences -----------------------------------------------------------------------------------


def unit_of(text):
    """The unit of the last digit of a number that is written."""
    mantissa, _, exponent = text.partition("e")
    decimals = len(mantissa.partition(".")[2])
    if not decimals and not exponent:  # 1200 may have been rounded to hundreds
        decimals = -(len(mantissa) - len(mantissa.rstrip("0"))) if float(text) else 0
    return 10.0 ** (int(exponent or 0) - decimals)


def as_stated(text, true):
    """Why a number that stands without an error is not the true one; empty where it is."""
    off = abs(float(text) - true)
    return "" if off <= unit_of(text) + TIE * abs(true) else f"{text} is {true!r}"


def range_as_stated(text, true):
    """Why a range, or a number, is not that of the true values, an array."""
    ends = text.split(" to ")
    true = np.asarray(true, float)
    true = true[np.isfinite(true)]
    if text == "none" or not true.size:
        return "" if text == "none" and not true.size else f"{text} of {true}"
    return "; ".join(filter(None, (as_stated(ends[0], true.min()), as_stated(ends[-1], true.max()))))


def read(sentences, pattern):
    """(sentence, match) of every sentence with a pattern, in which RANGE and NUMBER stand for theirs."""
    number = f"({NUMBER}(?: to {NUMBER})?|none)"
    whole = re.compile(pattern.replace("RANGE", number).replace("NUMBER", f"({NUMBER})"))
    return [(sentence, match) for sentence in sentences for match in whole.finditer(sentence)]


def ranges(sentences, pattern, *true):
    """The check of the ranges in a pattern against arrays of true values, one a range."""
    return [
        (sentence, "; ".join(filter(None, map(range_as_stated, match.groups(), true))))
        for sentence, match in read(sentences, pattern)
    ]


def with_error(text, error, true):
    """Why a number with its error excludes the true one."""
    off = abs(float(text) - true)
    return "" if off <= float(error) + TIE * abs(true) else f"{text} +- {error} is {true!r}"


# --- the true numbers ---------------------------------------------------------------------------------------


def rods_of(view):
    """The rod of every point, in their order."""
    columns = view.point_columns
    rows = zip(*(columns[name] for name in LINEAR_PARAMETERS), strict=True)
    return [Rod(*map(float, row)) for row in rows]


def leading(rod):
    """(leading eigenvalue, the next one)."""
    w = solve_spectrum(rod, EXACT).eigenvalues
    return complex(w[0]), complex(w[1])


def is_change(rod, name, at, kind):
    """Whether the straight rod changes in this way where a parameter has a value."""
    before, after = (leading(replace(rod, **{name: at * (1 + side * BESIDE)})) for side in (-1, 1))
    if kind == "onset":
        return before[0].imag == before[1].imag == 0 and after[0].imag > 0
    signs = {"hopf": (-1, 1), "restabilization": (1, -1)}[kind]
    return tuple(np.sign([before[0].real, after[0].real])) == signs


def changes_of(view, name):
    """(rod, kind, value) of every change of stability and onset on the lines over a parameter."""
    found = []
    for line in lines_over(view, name):
        low, high = float(line.x.min()), float(line.x.max())
        rod = Rod(**{n: line.parameters.get(n, low) for n in LINEAR_PARAMETERS})
        if low < high:
            for crossing in transitions(ParameterPath(rod, name), low, high).crossings:
                kind, after = crossing.kind.name, crossing.unstable_after
                if kind == "onset" or (kind, after) in (("hopf", 2), ("restabilization", 0)):
                    found.append((rod, kind, crossing.at))
    return found


KINDS = {"F** (straight": "hopf", "restabilization (straight": "restabilization", "F* (straight": "onset"}
ALONG = {
    "the straight rod starts to beat, as": "hopf",
    "the straight rod is stable again, as": "restabilization",
}
PLACE = rf"between ({NUMBER}) and ({NUMBER})|(?<!= )(?<![\w.+-])({NUMBER})(?= for | and | to | \(\+-)"


def threshold_sentences(view, sentences):
    """The check of every sentence that states thresholds along a parameter."""
    found = []
    for sentence in sentences:
        kind = next((kind for start, kind in (KINDS | ALONG).items() if sentence.startswith(start)), None)
        if kind is None:
            continue
        along = re.search(r"as (\w+) grows", sentence)
        name = along[1] if along else "F"
        places = sentence.split("at " + name if along else ": ", 1)[1].split(", frequency")[0]
        error = re.search(rf"\(\+- ({NUMBER})\)", places)
        true = [(rod, at) for rod, kind_of, at in changes_of(view, name) if kind_of == kind]
        why = [_misplaced(match, error, true, name, kind) for match in re.finditer(PLACE, f"{places} ")]
        found.append((sentence, "; ".join(filter(None, why)) if why else "no number was read"))
    return found


def _misplaced(match, error, true, name, kind):
    """Why a stated place is none at which a rod of the lines changes."""
    low, high, at = match.groups()
    if at is None:
        inside = [
            value
            for _, value in true
            if float(low) <= value * (1 + 1e-5) and value <= float(high) * (1 + 1e-5)
        ]
        return "" if inside else f"nothing between {low} and {high}"
    if error is None:
        return f"{at} has no error"
    rod, value = min(true, key=lambda pair: abs(pair[1] - float(at)), default=(None, inf))
    if rod is None or with_error(at, error[1], value):
        return f"{at} +- {error[1]} is {value!r}"
    return "" if is_change(rod, name, float(at), kind) else f"eigenvalues do not change at {at}"


# --- the sentences of each task ----------------------------------------------------------------------------


def spectrum_sentences(view, sentences, _):
    eigenvalues = np.array([leading(rod)[0] for rod in rods_of(view)])
    numbers = [count_right_of(0.0, rod).number for rod in rods_of(view)]
    found = ranges(
        sentences,
        "leading growth rate RANGE 1/tau2, frequency RANGE rad/tau2",
        eigenvalues.real,
        eigenvalues.imag,
    )
    for word, true in (("stable", sum(n == 0 for n in numbers)), ("unstable", sum(n > 0 for n in numbers))):
        found += [
            (sentence, "" if int(match[1]) == true else f"{true} are {word}")
            for sentence, match in read(sentences, rf"(?<!\w){word} at NUMBER[ (,]")
        ]
    for sentence, match in read(sentences, "straight rod: (stable|unstable) at all NUMBER point"):
        right = all((n > 0) == (match[1] == "unstable") for n in numbers) and int(match[2]) == len(numbers)
        found.append((sentence, "" if right else f"unstable modes: {numbers}"))
    if view.variables["status"].size == 1:
        found += _eigenvalue_sentences(rods_of(view)[0], sentences, numbers[0])
    return found + threshold_sentences(view, sentences)


def _eigenvalue_sentences(rod, sentences, unstable):
    """Of the one point of a file."""
    true = solve_spectrum(rod, SpectrumRequest(6, 1e-12, True)).eigenvalues
    stated = f"({NUMBER})(?: \\(\\+- ({NUMBER})\\))?"
    found = []
    for sentence, match in read(sentences, rf"mode (\d+): growth rate {stated} 1/tau2, frequency {stated}"):
        w = true[int(match[1]) - 1]
        pairs = ((match[2], match[3], w.real), (match[4], match[5], w.imag))
        found.append((sentence, "; ".join(filter(None, (with_error(a, b or 0, c) for a, b, c in pairs)))))
    for sentence, match in read(sentences, r"^unstable modes: NUMBER, proved"):
        found.append((sentence, "" if int(match[1]) == unstable else f"{unstable} are unstable"))
    return found


def modes_sentences(view, sentences, keywords):
    v = told_of("modes", keywords | {"accuracy": FINE["modes"]})[0].variables
    growth, time = (
        np.where(np.isfinite(v["transient_growth"]), v[n], np.nan)
        for n in ("transient_growth", "transient_time")
    )
    found = ranges(sentences, "condition of the leading eigenvalue: RANGE", v["condition"][..., 0])
    found += ranges(sentences, "numerical abscissa: RANGE 1/tau2", v["numerical_abscissa"])
    found += ranges(sentences, "largest transient growth: RANGE times, at t = RANGE tau2", growth, time)
    return found + spectrum_sentences(view, sentences, keywords)


def thresholds_sentences(view, sentences, keywords):
    """Of a grid the first thresholds of every kind, of a single rod all with their errors."""
    columns = [np.broadcast_to(c, view.variables["status"].size) for c in view.point_columns.values()]
    found, first = [], {"hopf": [], "restabilization": [], "onset": []}
    for row in zip(*columns, strict=True):
        rod = Rod(0.0, *map(float, row))
        end = min(keywords["F_max"], rod.k1 * (1 - 1e-6))
        crossings = transitions(ParameterPath(rod, "F"), 0.0, end).crossings
        for kind, each in first.items():
            each.append(next(((c.at, c) for c in crossings if c.kind.name == kind), (np.nan, None)))
        if len(columns[0]) == 1:
            found += _crossing_sentences(rod, crossings, sentences)
    for kind, start in (
        ("hopf", r"F\*\* \(straight"),
        ("restabilization", "stable again"),
        ("onset", r"F\* \(straight"),
    ):
        F = np.array([at for at, _ in first[kind]])
        place = r"(?: \([^)]*\))?"
        pattern = rf"^{start}.*: F = NUMBER{place}(?: to NUMBER{place})?, at (?:all|NUMBER) of NUMBER rod"
        for sentence, match in read(sentences, pattern):
            low, high = match[1], match[2] or match[1]
            there, rods = int(np.isfinite(F).sum()), len(F)
            why = [range_as_stated(low if low == high else f"{low} to {high}", F)]
            if int(match[3] or rods) != there or int(match[4]) != rods:
                why.append(f"{there} of {rods} have one")
            found.append((sentence, "; ".join(filter(None, why))))
    return found


def _crossing_sentences(rod, crossings, sentences):
    """Of the crossings of the one rod of a file."""
    found = []
    for sentence, match in read(
        sentences, rf"^(\w+) at F = NUMBER \(\+- ({NUMBER})\).*growth rate NUMBER 1/tau2, frequency NUMBER"
    ):
        near = min(crossings, key=lambda c: abs(c.at - float(match[2])))
        why = [with_error(match[2], match[3], near.at)]
        why += [as_stated(match[4], near.growth_rate), as_stated(match[5], near.frequency)]
        if match[1] in ("onset", "restabilization") and not is_change(rod, "F", near.at, match[1]):
            why.append("eigenvalues do not change there")
        found.append((sentence, "; ".join(filter(None, why))))
    return found


def criticality_sentences(view, sentences, keywords):
    v = told_of("criticality", keywords | {"accuracy": FINE["criticality"]})[0].variables
    found = []
    if view.variables["status"].size > 1:
        first = [v[name][..., 0] for name in ("crossing_F", "amplitude_coefficient")]
        found += ranges(sentences, "first Hopf point: .*; F = RANGE, a = RANGE L", *first)
        every = [v[name] for name in ("amplitude_coefficient", "frequency_slope")]
        return found + ranges(sentences, "all Hopf points: .*; a = RANGE L, b = RANGE L", *every)
    v, i = {name: v[name].ravel() for name in v}, -1
    stated = rf"NUMBER \(\+- ({NUMBER})\)"
    for sentence in sentences:
        why = []
        for _, match in read([sentence], rf"at F = {stated}, frequency {stated}"):
            i += 1
            why += [with_error(match[1], match[2], v["crossing_F"][i])]
            why += [with_error(match[3], match[4], v["crossing_frequency"][i])]
        for symbol, name in (("c", "landau"), ("dw/dF", "growth_slope")):
            for _, match in read([sentence], rf"Re {symbol} = {stated}, Im {symbol} = {stated}"):
                why += [with_error(match[1], match[2], v[f"{name}_real"][i])]
                why += [with_error(match[3], match[4], v[f"{name}_imag"][i])]
        for symbol, name in (("a", "amplitude_coefficient"), ("b", "frequency_slope")):
            for _, match in read([sentence], rf"^  {symbol} = {stated}"):
                why += [with_error(match[1], match[2], v[name][i])]
        for side, word in ((-1, "supercritical"), (1, "subcritical")):
            if sentence.startswith(f"  {word}") and v["criticality"][i] != side:
                why += [f"its side is {v['criticality'][i]}"]
        found += [(sentence, "; ".join(filter(None, why)))] if why else []
    return found


def cycle_sentences(view, sentences, keywords):
    fine = told_of("limit_cycle", keywords | {"accuracy": FINE["limit_cycle"]})[0]
    words = [
        np.array([view_.flags[int(s)] for s in view_.variables["status"].ravel()]) for view_ in (view, fine)
    ]
    v = {name: np.asarray(fine.variables[name]) for name in fine.variables}
    beats = (words[0] == "cycle").reshape(v["status"].shape)
    if not (words[0] == words[1]).all() or not beats.any():  # next to a Hopf point a motion may take long
        return threshold_sentences(view, sentences)
    found = ranges(
        sentences,
        "^period: RANGE tau2; largest y of the tip: RANGE L",
        v["period"][beats],
        v["tip_y_max"][beats],
    )
    ratio = v["frequency"][beats] / v["linear_frequency"][beats]
    found += ranges(
        sentences,
        "frequency RANGE rad/tau2, over that of the leading mode RANGE",
        v["frequency"][beats],
        ratio,
    )
    tips = [v[f"tip_{name}"][beats] for name in ("x_min", "x_max", "theta_max")]
    found += ranges(sentences, "least x RANGE L, largest x RANGE L, largest theta RANGE rad", *tips)
    found += ranges(sentences, r"power of the force, mean: RANGE k3", v["injection_mean"][beats])
    found += ranges(
        sentences,
        r"^multiplier: RANGE;.*least stretch: RANGE",
        v["multiplier"][beats],
        v["least_stretch"][beats],
    )
    eigenvalues = np.array([leading(rod)[0] for rod in rods_of(view)])
    found += ranges(
        sentences,
        "straight rod: leading growth rate RANGE 1/tau2, frequency RANGE",
        eigenvalues.real,
        eigenvalues.imag,
    )
    for pattern, name in (
        ("^period", "period"),
        ("^largest y of the tip", "tip_y_max"),
        ("^largest Floquet.*1", "multiplier"),
    ):
        for sentence, match in read(sentences, rf"{pattern}: NUMBER \(\+- ({NUMBER})\)"):
            found.append((sentence, with_error(match[1], match[2], float(v[name].max()))))
    return found + threshold_sentences(view, sentences)


def diagram_sentences(view, sentences, keywords):
    line, row = "F", next(name for name in view.parameters if len(view.axes[name]) > 1)
    values, rows = view.variables[line], view.axes[row]
    fixed = {name: float(view.axes[name][0]) for name in view.parameters}
    true, classes = {}, []
    for value in rows:
        rod = Rod(0.0, **(fixed | {row: float(value)}))
        stop = min(float(values[-1]), rod.k1 * (1 - 1e-6))  # beyond it the rod is crushed
        crossings = transitions(ParameterPath(rod, "F"), float(values[0]), stop).crossings
        for crossing in crossings:
            true.setdefault(crossing.kind.name, []).append((crossing.at, float(value)))
        for F in values:
            if rod.k1 <= F:
                classes.append("crushed")
                continue
            w = leading(replace(rod, F=float(F)))[0]
            classes.append("flutter" if w.real > 0 else "oscillatory" if w.imag else "monotone")
    found = []
    for word in ("monotone", "oscillatory", "flutter", "crushed"):
        share = 100 * classes.count(word) / len(classes)
        found += [
            (sentence, as_stated(match[1], share))
            for sentence, match in read(sentences, rf"^of the grid:.*?NUMBER % {word}")
        ]
    for kind, places in true.items():
        at, of_row = np.array(places).T
        found += ranges(sentences, rf"^{kind}: on \d+ of \d+ rows?, F = RANGE, {row} = RANGE", at, of_row)
    return found


def branch_sentences(view, sentences, keywords):
    fine = told_of("branch", keywords | {"accuracy": FINE["branch"]})[0].variables
    coarse = {name: array.ravel() for name, array in view.variables.items()}
    v = {name: array.ravel() for name, array in fine.items()}
    if not np.array_equal(coarse["special_kind"], v["special_kind"]):
        return []
    kinds = v["special_kind"] > 0
    found, stated = [], rf"NUMBER \(\+- ({NUMBER})\)"
    for sentence, match in read(sentences, rf"F = {stated}(?:, period NUMBER tau2, largest tip y NUMBER L)?"):
        near = int(np.argmin(np.where(kinds, np.abs(v["special_at"] - float(match[1])), inf)))
        why = [with_error(match[1], match[2], v["special_at"][near])]
        if match[3]:
            why += [
                as_stated(match[3], v["special_period"][near]),
                as_stated(match[4], v["special_tip_y_max"][near]),
            ]
        found.append((sentence, "; ".join(filter(None, why))))
    return found


CHECKS = {
    "spectrum": spectrum_sentences,
    "modes": modes_sentences,
    "thresholds": thresholds_sentences,
    "criticality": criticality_sentences,
    "limit_cycle": cycle_sentences,
    "phase_diagram": diagram_sentences,
    "branch": branch_sentences,
}
