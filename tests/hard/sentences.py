"""Sweeps of random rods and arms, the page that `show` prints of each, and the same numbers from the solvers.

With an error beside it a number must lie within it of the true one; an end of a range within one unit of its
last digit, half for its error, half for rounding. True numbers of motions, branches and normal forms are
those of a far smaller accuracy asked for; those of spectra and thresholds come from eigenvalues on both sides
of a stated place, which share no code with the covering. What is said in SI units is converted here anew.
"""

import re
from dataclasses import replace
from math import inf, log10
from pathlib import Path

import numpy as np
from rods import rod_of

import rodsweep as rs
from rodsweep.api.dataset import view_of_dataset
from rodsweep.determinant.certificate.winding_number import count_right_of
from rodsweep.model.arm.arm import SlenderArm
from rodsweep.model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES
from rodsweep.model.rod import Rod
from rodsweep.post.branch_curves import RodBranches
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum
from rodsweep.sweep.points.points import lines_along

from .arm_sentences import arm_sentences, random_arm, region_as_stated
from .branch_sentences import branch_sentences, followed_beyond
from .page import (
    NUMBER,
    TIE,
    as_stated,
    at_most,
    counts,
    page_of,
    parameter_lines,
    range_as_stated,
    ranges,
    read,
    regions,
    relative,
    unit_of,
    with_error,
)
from .truths import (
    BESIDE,
    SHORT_OF_CRUSHED,
    changes_along,
    changes_of,
    changes_over_force,
    is_change,
    leading,
    rods_of,
    time_is_known,
)

TASKS = ("spectrum", "modes", "thresholds", "criticality", "limit_cycle", "phase_diagram", "branch")
FINE = {"criticality": 1e-9, "limit_cycle": 1e-7, "modes": 1e-10, "branch": 1e-7}
"""Accuracy to which true numbers are computed, by task."""
MODE_FIELDS = ("Y", "Theta", "h2", "Pi", "adjoint_Y")
MANY = 30
"""Modes among which that of a curve is, though others grow there."""
ROUNDING = 1e-11
"""Relative error of an eigenvalue that is solved alone."""
BETWEEN_NODES = 4e-3
"""Error of the least stretch, taken at nodes, in units of its distance from 1. It adds to that of extrema."""
FOLD_BESIDE, FOLD_WIDTH = 1e-5, 0.05
"""Relative distances from a fold of a curve at which, and within which, changes are counted."""


def random_sweep(index):
    """(task, keywords of `rs.sweep`) of that number, whatever others are asked for; some are of arms."""
    random = np.random.default_rng([33, index])
    task = TASKS[index % len(TASKS)]
    count = 1 if random.random() < 0.3 else int(random.integers(2, 4))
    keywords = (
        {"gamma1": float(random.uniform(0.5, 1))} if task in ("limit_cycle", "criticality", "branch") else {}
    )
    top = 10 ** random.uniform(1.6, 2.3)
    if (index + index // len(TASKS)) % 3 == 1:
        keywords = _of_an_arm(random, task, count)
        arm = keywords["arm"]
        first = {
            name: arm[name][0] if isinstance(arm[name], list) else arm[name]
            for name in arm
            if name != "pressure"
        }
        top = min(top, 0.9 * SlenderArm(**first).k1)
    else:
        varied = str(random.choice(["k1", "k2", "gamma3"]))
        rods = {name: _drawn(random, name, count if name == varied else 1) for name in ("k1", "k2", "gamma3")}
        if task == "branch":  # where branches turn back
            rods["k1"] = sorted(float(10 ** random.uniform(2, 4)) for _ in rods["k1"])
        keywords |= {name: values if len(values) > 1 else values[0] for name, values in rods.items()}
        top = min(0.97 * min(rods["k1"]), top)
        keywords |= _over_force(random, task, top)
        if task == "phase_diagram":
            rows = np.sort(_drawn(random, varied, 3)).tolist()
            keywords |= {varied: rows if len(rows) > 1 else [*rows, 1.0]} | _of_diagrams(random)
    _rarely_asked(np.random.default_rng([35, index]), task, keywords)
    if "arm" in keywords and task != "phase_diagram":
        _over_drag(np.random.default_rng([34, index]), keywords["arm"])
    if task in ("thresholds", "criticality"):
        keywords["F_max"] = top
    if task == "branch":
        keywords |= {"stop": top}
    if task in FINE or keywords.get("cycles"):
        keywords["accuracy"] = float(
            10 ** random.uniform(-5, -3 if task in ("branch", "phase_diagram") else -2)
        )
    return task, keywords


def _over_force(random, task, top):
    """Values of the force for a task that takes some, at times of another parameter."""
    if task == "phase_diagram":
        return {"F": {"start": 0.0, "stop": top, "num": int(random.integers(5, 60))}}
    if task not in ("spectrum", "modes", "limit_cycle"):
        return {}
    points = int(random.integers(1, 7 if task == "spectrum" else 5))
    F = np.sort(random.uniform(0.05 * top, top, points)).tolist()
    if random.random() < 0.15:
        return {"F": F[-1], "k2": np.sort(10 ** random.uniform(0.5, 5, 4)).tolist()}
    return {"F": F if points > 1 else F[0]}


def _of_diagrams(random):
    """Options of a phase diagram: curves alone in most cases, else sides or cycles, which take long."""
    kind = random.random()
    if kind < 0.2:  # close to the partial beam, whose cycles turn back
        k1 = np.sort(random.uniform(140, 220, 3)).tolist()
        return {
            "k1": k1,
            "k2": 1e4,
            "gamma3": 1e-4,
            "cycles": True,
            "F": {"start": 0.0, "stop": 110, "num": 23},
        }
    return {"criticality": True} if kind < 0.5 else {}


def _of_an_arm(random, task, count):
    """Keywords of a task for a random arm."""
    loaded = task in ("spectrum", "modes", "limit_cycle", "phase_diagram")
    arm = random_arm(random, load=loaded, varied=count > 1 and task not in ("branch", "phase_diagram"))
    if loaded:
        most = float(arm["pressure"].split()[0])
        shares = np.sort(random.uniform(0.2, 1, 1 if isinstance(arm.get("length"), list) else 3))
        arm["pressure"] = [f"{most * share:.5g} kPa" for share in shares]
    if task != "phase_diagram":
        return {"arm": arm}
    arm["pressure"] = {"start": "0 kPa", "stop": f"{most:.5g} kPa", "num": 7}
    return {"arm": arm, "gamma3": np.sort(10 ** random.uniform(-4, -1, 3)).tolist()}


def _over_drag(random, arm):
    """Give an arm in some cases all drags, and loads relative to its flutter."""
    if random.random() < 0.4:
        arm["drag"] = "range"
    if "pressure" in arm and random.random() < 0.3:
        del arm["pressure"]
        arm["pressure_over_flutter"] = np.sort(random.uniform(0.5, 2, 2)).round(3).tolist()


def _rarely_asked(random, task, keywords):
    """Add, in some cases, options without which a page lacks sentences or states more."""
    if random.random() > 0.3:
        return
    if task == "limit_cycle":
        k2, gamma3 = (np.atleast_1d(keywords.get(name, 1.0)) for name in ("k2", "gamma3"))
        tau1 = (k2 < inf).all() and (gamma3 > 0).all()  # gamma3/k2
        keywords |= {"time": "tau1"} if tau1 and random.random() < 0.5 else {"method": "integration"}
    if task in ("thresholds", "criticality"):  # lists that are full
        keywords["crossings"] = int(random.integers(1, 3))
    if task == "spectrum" and isinstance(keywords.get("F"), list):  # rods that are pulled
        keywords["F"] = [-F for F in keywords["F"][::-1]] if random.random() < 0.3 else keywords["F"]
    if keywords.get("cycles"):
        keywords["cycle_accuracy"] = float(10 ** random.uniform(-7, -4))


def _drawn(random, name, count):
    """Sorted values of a parameter, in and out of its limit."""
    if name == "gamma3":
        values = [0.0 if random.random() < 0.15 else 10 ** random.uniform(-8, -0.5) for _ in range(count)]
    else:
        low = log10(70) if name == "k1" else 1.0
        values = [inf if random.random() < 0.1 else 10 ** random.uniform(low, 7) for _ in range(count)]
    return sorted(set(map(float, values)))


def solved(task, keywords):
    """The results of a sweep, as `show` sees them."""
    return view_of_dataset(rs.sweep(task, progress=False, **keywords), Path(f"{task}.h5")).as_list


def wrong_sentences(task, keywords):
    """(lines with a wrong number or one that nothing reads, with what is wrong; how many were read)."""
    view = solved(task, keywords)
    page = page_of(view)
    better = {name: value for name, value in keywords.items() if (name, value) != ("method", "integration")}
    fine = solved(task, better | {"accuracy": FINE[task]}) if task in FINE else view
    found = CHECKS[task](view, page, keywords, fine) + table_sentences(view, page, keywords)
    found += failure_sentences(view, page)
    if view.quantities:
        found += arm_sentences(view, page, fine)
    wrong = [(line, why) for line, why in found if why]
    wrong += [(line, f"nothing reads {', '.join(numbers)}") for line, numbers in page.unread()]
    return wrong, sum(map(len, page.seen.values()))


def table_sentences(view, page, keywords):
    """The check of the tables of statuses and of parameters."""
    status, found = view.variables["status"].ravel().tolist(), []
    for word, number in ((word, number) for number, word in view.status_flags.items()):
        found += counts(page, rf"^{word} +NUMBER  ", status.count(number))
    along = {"F": view.variables["F"]} if view.task == "phase_diagram" and "F" in view.variables else {}
    for name, column in (view.quantities | view.point_columns | along).items():
        values = np.unique(np.asarray(column, float))
        for line, why, low, high, _ in parameter_lines(page, name, values):
            if name in view.typed_units:  # in other units, which `arm_sentences` reads
                continue
            texts = (low, values.min()), (high, values.max())
            ends = ["" if text == "inf" and end == inf else as_stated(text, end) for text, end in texts]
            found.append((line, "; ".join(filter(None, (why, *ends)))))
    return found


FAILURE = re.compile(r"(\w+), for example at ([^:]+): .+")


def failure_sentences(view, page):
    """The check of the example points of failures, which have this status; the solver says the reason."""
    found = []
    values = {word: value for value, word in view.status_flags.items()}
    for line in page:
        if not (match := FAILURE.fullmatch(line)):
            continue
        page.mark(line, match.span())
        here = view.variables["status"].ravel() == values[match[1]]
        for name, value in (pair.split(" = ") for pair in match[2].split(", ")):
            column = view.point_columns.get(name, float(value))
            here &= np.isclose(column, float(value), rtol=1e-8, atol=0)
        found.append((line, "" if here.any() else "no such point has this status"))
    return found


KINDS = {"F** (straight": "hopf", "restabilization (straight": "restabilization", "F* (straight": "onset"}
ALONG = {
    "the straight rod starts to flutter, as": "hopf",
    "the straight rod is stable again, as": "restabilization",
}
AFTER_PLACE = r"(?= for | and | to |, found on | \(\+-)"
PLACE = rf"between ({NUMBER}) and ({NUMBER})|(?<!= )(?<![\w.+-])({NUMBER}){AFTER_PLACE}"


def threshold_sentences(view, page):
    """The check of every sentence that states thresholds along a parameter."""
    found = []
    for line in page:
        kind = next((kind for start, kind in (KINDS | ALONG).items() if line.startswith(start)), None)
        if kind is None:
            continue
        along = re.search(r"as (\w+) grows", line)
        name = along[1] if along else "F"
        begin = line.index(": ") + 2 if not along else line.index(f"at {name}: ") + len(name) + 5
        places = line[begin:].split(", frequency")[0]
        error = re.search(rf"\(\+- ({NUMBER})\)", places)
        true = [(rod, at, w) for rod, kind_of, at, w in changes_of(view, name) if kind_of == kind]
        why = []
        for match in re.finditer(PLACE, f"{places} "):
            why.append(_misplaced(match, error, true, name, kind))
            for group in (1, 2, 3):
                page.mark(line, tuple(begin + place for place in match.span(group)))
        for match in re.finditer(rf"\(\+- ({NUMBER})\)", places):
            page.mark(line, tuple(begin + place for place in match.span(1)))
        for _, match in read(page, r", frequency NUMBER rad/tau2", only=line):
            why += [as_stated(match[1], true[0][2])]
        read(page, r"for (?:\w+ = NUMBER(?:, (?=\w+ =))?)+", only=line)
        for _, match in read(page, r" for \w+ = NUMBER(?:, \w+ = NUMBER)?(?:, \w+ = NUMBER)?", only=line):
            columns = np.concatenate(list(view.point_columns.values()))
            why += [near_one_of(text, columns) for text in match.groups() if text]
        for _, match in read(page, r", found on NUMBER of NUMBER lines? of points along", only=line):
            lines = [each for each in lines_along(view.point_columns, name) if len(each.values) > 1]
            having = len(
                {
                    tuple(getattr(rod, n) for n in NON_OPTIONAL_LINEAR_PARAMETER_NAMES if n != name)
                    for rod, *_ in true
                }
            )
            # Between two points of a spectrum with several changes only one of them is located.
            is_number = int(match[1]) == having or (view.task != "thresholds" and int(match[1]) < having)
            right = is_number and int(match[2]) == len(lines)
            why += [] if right else [f"on {having} of {len(lines)} lines"]
        found.append((line, "; ".join(filter(None, why)) if why else "no number was read"))
    return found


def near_one_of(text, values):
    """Why a number is none of several."""
    return as_stated(text, min(values, key=lambda value: abs(value - float(text))))


def _misplaced(match, error, true, name, kind):
    """Why a stated place is none at which a rod of the lines changes."""
    low, high, at = match.groups()
    if at is None:
        inside = [
            value
            for _, value, _ in true
            if float(low) <= value * (1 + 1e-5) and value <= float(high) * (1 + 1e-5)
        ]
        return "" if inside else f"nothing between {low} and {high}"
    if error is None:
        return f"{at} has no error"
    rod, value, _ = min(true, key=lambda one: abs(one[1] - float(at)), default=(None, inf, 0))
    if rod is None or with_error(at, error[1], value):
        return f"{at} +- {error[1]} is {value!r}"
    return "" if is_change(rod, name, float(at), kind) else f"eigenvalues do not change at {at}"


# --- the sentences of each task ----------------------------------------------------------------------------


def spectrum_sentences(view, page, keywords, fine):
    rods, v = rods_of(view), view.variables
    eigenvalues = np.array([leading(rod)[0] for rod in rods])
    numbers = np.array([count_right_of(0.0, rod).number for rod in rods])
    pattern = "leading growth rate RANGE 1/tau2, frequency RANGE rad/tau2"
    found = ranges(page, pattern, eigenvalues.real, eigenvalues.imag)
    found += counts(page, r"^straight rod, of NUMBER points?:", len(rods))
    for word, there in (("stable", numbers == 0), ("unstable", numbers > 0)):
        found += regions(page, rf"(?<!\w){word} at", there, view.point_columns)
    for line, match in read(page, "straight rod: (stable|unstable) at all NUMBER point"):
        right = all((n > 0) == (match[1] == "unstable") for n in numbers) and int(match[2]) == len(numbers)
        found.append((line, "" if right else f"unstable modes: {numbers}"))
    size = np.hypot(v["growth_rate"], v["frequency"])
    stated = (v["error_estimate"] / size)[np.isfinite(size)]
    for line, match in read(page, "^relative error of the eigenvalues: at most NUMBER, median NUMBER"):
        off = max(
            relative(np.hypot(w.real, w.imag), abs(leading(rod)[0]))
            for rod, w in zip(
                rods, (v["growth_rate"] + 1j * v["frequency"]).reshape(len(rods), -1)[:, 0], strict=True
            )
        )
        why = [] if off <= float(match[1]) + ROUNDING else [f"an error is {off}"]
        why += [f"median {np.median(stated)}"] if abs(np.median(stated) / float(match[2]) - 1) > 0.06 else []
        found.append((line, "; ".join(why)))
    proved = (numbers.max(), int(v["certified"].sum()), len(rods))
    found += counts(
        page,
        "^largest number of unstable modes: NUMBER; the number is proved at NUMBER of NUMBER point",
        *proved,
    )
    if len(rods) == 1:
        found += _eigenvalue_sentences(rods[0], page, numbers[0])
    return found + threshold_sentences(view, page)


def _eigenvalue_sentences(rod, page, unstable):
    """Of the one point of a file."""
    true = solve_spectrum(rod, SpectrumRequest(6, 1e-12, True)).eigenvalues
    stated = f" +({NUMBER})(?: +({NUMBER}(?<=e[-+]\\d\\d)))?"  # an error has an exponent, 0 has no error
    found = []
    for line, match in read(page, rf"^(\d+){stated}{stated}$"):
        w = true[int(match[1]) - 1]
        pairs = ((match[2], match[3], w.real), (match[4], match[5], w.imag))
        found.append((line, "; ".join(filter(None, (with_error(a, b or 0, c) for a, b, c in pairs)))))
    return found + counts(page, r"^unstable modes: NUMBER, proved", unstable)


def modes_sentences(view, page, keywords, fine):
    v, own = fine.variables, view.variables
    unbounded = np.isinf(v["transient_growth"])
    growth, time = (np.where(unbounded, np.nan, v[n]) for n in ("transient_growth", "transient_time"))
    time = np.where((own["transient_time"] == 0) | time_is_known(view), time, np.nan)
    found = ranges(page, "condition number of the leading eigenvalue: RANGE", v["condition"][..., 0])
    found += ranges(page, "numerical abscissa: RANGE 1/tau2", v["numerical_abscissa"])
    found += ranges(page, "largest transient growth: RANGE times", growth)
    when = ranges(page, "largest transient growth: .* times, at t = RANGE tau2", time)
    told = bool(when) == bool(np.isfinite(time).any())
    found += when if told else [(page[0], "the time of the largest growth is left out, or not known")]
    found += counts(page, "^growth without bound at NUMBER point", unbounded.sum())
    fields = [own[f"{name}_real"] + 1j * own[f"{name}_imag"] for name in MODE_FIELDS]
    exact = [v[f"{name}_real"] + 1j * v[f"{name}_imag"] for name in MODE_FIELDS]
    off = [np.abs(a - b).max(axis=-1) / np.abs(b).max(axis=-1) for a, b in zip(fields, exact, strict=True)]
    found += at_most(page, "^error of the modes, relative: worst NUMBER", float(np.nanmax(off)))
    unknown = ~np.isfinite(view.variables["mode_error"]).all(axis=-1)
    found += counts(
        page, "^error of the modes,.*; not known at NUMBER of NUMBER", unknown.sum(), unknown.size
    )
    return found + spectrum_sentences(view, page, keywords, fine)


def thresholds_sentences(view, page, keywords, _):
    """Of a grid the first thresholds of every kind, of a single rod all with their errors."""
    columns, v = view.point_columns, view.variables
    count = v["status"].size
    rods = [
        rod_of(0.0, *(float(columns[name][i]) for name in NON_OPTIONAL_LINEAR_PARAMETER_NAMES[1:]))
        for i in range(count)
    ]
    top = keywords.get("F_max", 200.0)
    every = [changes_over_force(rod, top) for rod in rods]
    found = _search_sentences(view, page, every, "rod")
    found += _crossing_sentences(rods[0], every[0], page) if count == 1 else []
    for kind, start, noun in (
        ("hopf", r"F\*\* \(straight", "frequency"),
        ("restabilization", r"restabilization \(straight", "frequency"),
        ("onset", r"F\* \(straight", "growth rate"),
    ):
        first = [next((c for c in each if c.kind.name == kind), None) for each in every]
        F = np.array([c.value if c else np.nan for c in first])
        beside = np.array(
            [(c.growth_rate if kind == "onset" else c.frequency) if c else np.nan for c in first]
        )
        there = int(np.isfinite(F).sum())
        place = r"(?: \(([^)]*)\))?"
        pattern = rf"^{start}.*: F = NUMBER{place}(?: to NUMBER{place})?"
        pattern += rf", at (?:all|NUMBER of) NUMBER rods?; {noun} RANGE"
        for line, match in read(page, pattern):
            low, high = match[1], match[3] or match[1]
            why = [range_as_stated(low if low == high else f"{low} to {high}", F)]
            for text, i in ((match[2], np.nanargmin(F)), (match[4], np.nanargmax(F))):
                for name, number in re.findall(rf"(\w+) = ({NUMBER}|inf)", text or ""):
                    why += [] if number == "inf" else [as_stated(number, float(columns[name][i]))]
                    why += ["it is not inf"] if (number == "inf") != np.isinf(columns[name][i]) else []
            if int(match[5] or count) != there or int(match[6]) != count:
                why.append(f"{there} of {count} have one")
            why.append(range_as_stated(match[7], beside))
            found.append((line, "; ".join(filter(None, why))))
        found += counts(page, rf"^{start}[^:]*: at none of NUMBER rod", 0 if there else count)
        found += _monotony(view, page, kind, F)
    return found


def _monotony(view, page, kind, F):
    """Along how many lines a threshold rises or falls with a parameter."""
    found = []
    shape = view.variables["status"].shape
    for line, match in read(
        page,
        rf"^F_{kind} rises with (1/)?(\w+) on NUMBER of NUMBER lines? of rods"
        r"(?:, falls on NUMBER)?(?:, is constant on NUMBER)?(?:, is not monotone on NUMBER)?",
    ):
        axis = list(view.parameter_values).index(match[2])
        along = np.moveaxis(F.reshape(shape), axis, -1).reshape(-1, shape[axis])
        along = along[:, ::-1] if match[1] else along
        known = [row[np.isfinite(row)] for row in along if np.isfinite(row).sum() > 1]
        # Thresholds have twelve digits: two that agree in them do not differ.
        up = np.array([max(np.diff(row)) > 1e-12 * max(abs(row)) for row in known])
        down = np.array([min(np.diff(row)) < -1e-12 * max(abs(row)) for row in known])
        told = [int(text or 0) for text in match.groups()[2:]]
        true = [sum(up & ~down), len(known), sum(down & ~up), sum(~up & ~down), sum(up & down)]
        found.append((line, "" if told == true else f"it is {true}"))
        for _, items in read(page, r"is not monotone on \d+ \(([^)]*)\)", only=line):
            for name, text in re.findall(rf"(\w+) = ({NUMBER})", items[1]):
                found.append((line, near_one_of(text, view.parameter_values[name])))
    return found


def _crossing_sentences(rod, crossings, page):
    """Of the crossings of the one rod of a file."""
    found = []
    for line, match in read(
        page,
        r"^(onset|hopf|hopf_reverse|restabilization|real_again|real_leads|pair_leads) +"
        "NUMBER +NUMBER +NUMBER +NUMBER +NUMBER$",
    ):
        near = min(crossings, key=lambda c: abs(c.value - float(match[2])))
        why = [with_error(match[2], match[3], near.value)]
        why += [as_stated(match[4], near.growth_rate), as_stated(match[5], near.frequency)]
        if match[1] in ("onset", "restabilization") and not is_change(rod, "F", near.value, match[1]):
            why.append("eigenvalues do not change there")
        w = solve_spectrum(
            replace(rod, F=near.value * (1 + 10 * BESIDE)), SpectrumRequest(12, 1e-11, False)
        ).eigenvalues
        above = int((w.real > 0).sum())
        why += [] if int(match[6]) == above else [f"{above} modes are unstable above"]
        found.append((line, "; ".join(filter(None, why))))
    for line, match in read(page, r"(?:oscillation|flutter|flutter again|stable again) from F = NUMBER"):
        near = min(crossings, key=lambda c: abs(c.value - float(match[1])))
        found.append((line, as_stated(match[1], near.value)))
    for line, match in read(page, r"(?:^|; )NUMBER crossings? up to F = NUMBER$"):
        within = sum(c.value <= float(match[2]) for c in crossings)
        found.append((line, "" if int(match[1]) == within else f"there are {within}"))
    return found


HIDDEN = "; NUMBER more (?:is|are) not stored"
"""What a page says of changes for which a list has no room."""


def _search_sentences(view, page, every, noun):
    """How far was searched, how many crossings are stored, how accurate these are; every: the true ones."""
    v, rods = view.variables, len(every)
    proved = int(v["certified"].sum())
    found = counts(
        page, rf"^the list of crossings is proved complete for NUMBER of NUMBER {noun}", proved, rods
    )
    stored = (v["crossing_kind"] > 0).reshape(rods, -1)
    name = "crossing_at" if "crossing_at" in v else "crossing_F"
    off = 0.0
    for at, there, true in zip(v[name].reshape(rods, -1), stored, every, strict=True):
        if there.sum() != len(true) and v["crossing_count"].max() <= stored.shape[1]:
            found.append((page[0], f"{there.sum()} crossings are stored of {len(true)}"))
        off = max([off, *(min(abs(c.value - x) for c in true) for x in at[there] if true)])
    numbers = stored.sum(axis=1)
    found += counts(page, HIDDEN, sum(map(len, every)) - numbers.sum())
    for line, match in read(
        page, rf"^crossings stored: NUMBER, at most NUMBER on a {noun}(?:; absolute error at most NUMBER)?"
    ):
        why = (
            []
            if [int(match[1]), int(match[2])] == [numbers.sum(), numbers.max()]
            else [f"there are {numbers}"]
        )
        why += [f"an error is {off}"] if match[3] and off > 2 * float(match[3]) else []
        found.append((line, "; ".join(why)))
    if "F_end" in v:
        found += ranges(page, "^searched up to F = RANGE$", v["F_end"])
        found += ranges(
            page, "^searched up to F = RANGE; the list of crossings is (?:not )?proved", v["F_end"]
        )
        found += ranges(page, "^no threshold up to F = RANGE", v["F_end"])
    return found


def criticality_sentences(view, page, keywords, fine):
    v, own, columns = fine.variables, view.variables, view.point_columns
    count, extent = v["status"].size, v["criticality"].shape[-1]
    end = np.minimum(keywords["F_max"], columns["k1"] * (1 - 1e-9))
    found = ranges(page, "^searched up to F = RANGE;", end) + ranges(
        page, "^no Hopf point up to F = RANGE", end
    )
    proved = (int(own["certified"].sum()), count)
    found += counts(page, "list of Hopf points is proved complete for NUMBER of NUMBER rod", *proved)
    found += counts(page, HIDDEN, v["crossing_count"].sum() - (own["crossing_kind"] > 0).sum())
    if count == 1:
        return found + _normal_forms(page, {name: v[name].ravel() for name in v})
    having = (v["crossing_count"] > 0).ravel()
    found += counts(page, rf"^Hopf points at {having.sum()} of NUMBER rod", count)
    for line, match in read(page, r"^Hopf points at NUMBER of \d+ rods?(?: \(([^()]*)\))?$"):
        why = [] if int(match[1]) == having.sum() else [f"at {having.sum()} rods"]
        for name, text in re.findall(rf"(\w+) = ({NUMBER}(?: to {NUMBER})?)", match[2] or ""):
            why.append(range_as_stated(text, columns[name][having]))
        found.append((line, "; ".join(filter(None, why))))
    first = [v[name][..., 0] for name in ("crossing_F", "amplitude_coefficient")]
    found += ranges(page, "first Hopf point of each rod: .*; F = RANGE, a = RANGE L", *first)
    every = [v[name] for name in ("amplitude_coefficient", "frequency_slope")]
    found += ranges(page, "(?:all|stored) Hopf points: .*; a = RANGE L, b = RANGE L", *every)
    for words, sides in (
        ("first Hopf point of each rod", v["criticality"][..., 0]),
        ("(?:all|stored) Hopf points", v["criticality"]),
    ):
        for side, word in ((-1, "supercritical"), (1, "subcritical"), (0, "undecided")):
            found += counts(page, rf"^{words}: .*?NUMBER {word}", (sides == side).sum())
    both = {n: relative(own[n], v[n]) for n in ("amplitude_coefficient", "frequency_slope")}
    both |= {
        n: float(np.nanmax(np.abs(_complex(own, n) - _complex(v, n)) / np.abs(_complex(v, n)), initial=0))
        for n in ("landau", "growth_slope")
    }
    worst = (both["landau"], both["growth_slope"], both["amplitude_coefficient"], both["frequency_slope"])
    found += at_most(page, "worst relative errors: c NUMBER, dw/dF NUMBER, a NUMBER, b NUMBER", *worst)
    side = v["criticality"].reshape(-1, extent)
    for line, match in read(
        page, "^subcritical Hopf points, with the amplitude coefficient a, for ([^:]*): (.*)$"
    ):
        given = {name: float(x) for name, x in re.findall(rf"(\w+) = ({NUMBER}|inf)", match[1])}
        away = [
            sum(abs(columns[n][i] - x) / (1 + abs(x)) if np.isfinite(x) else 0 for n, x in given.items())
            for i in range(count)
        ]
        rod = int(np.argmin(away))
        F, a = (v[n].reshape(-1, extent)[rod] for n in ("crossing_F", "amplitude_coefficient"))
        why = [near_one_of(str(x), columns[n]) for n, x in given.items() if np.isfinite(x)]
        for at, i, size in re.findall(rf"F = ({NUMBER}) \(Hopf point (\d+), a = ({NUMBER}) L\)", match[2]):
            why += [as_stated(at, F[int(i) - 1]), as_stated(size, a[int(i) - 1])]
            why += [] if side[rod, int(i) - 1] == 1 else ["it is not subcritical"]
        found.append((line, "; ".join(filter(None, why))))
    return found


def _complex(v, name):
    return v[f"{name}_real"] + 1j * v[f"{name}_imag"]


HOPF_ROWS = {
    "F, ": "crossing_F",
    "frequency, ": "crossing_frequency",
    "Re c, ": "landau_real",
    "Im c, ": "landau_imag",
    "Re dw/dF, ": "growth_slope_real",
    "Im dw/dF, ": "growth_slope_imag",
    "a, ": "amplitude_coefficient",
    "b, ": "frequency_slope",
}
"""Variables in the rows of the table of Hopf points."""


def _normal_forms(page, v):
    """Every Hopf point of the one rod of a file: its sentence, and its two columns of the table."""
    found = []
    at = np.flatnonzero(v["crossing_kind"] > 0)
    beyond = "(the straight rod has NUMBER unstable modes? beyond it|the number)"
    said = read(page, rf"^(?:hopf|restabilization)\w* at F = NUMBER: .*; {beyond}")
    assert len(said) == len(at)
    for i, (line, match) in zip(at, said, strict=True):
        why = [as_stated(match[1], v["crossing_F"][i])]
        why += [] if match[3] is None or int(match[3]) == v["unstable_after"][i] else ["modes above"]
        for side, word in ((-1, "supercritical"), (1, "subcritical")):
            if f": {word}, " in line:
                why += [] if v["criticality"][i] == side else [f"its side is {v['criticality'][i]}"]
                above = "at larger F" in line
                other = above != (v["amplitude_coefficient"][i] > 0)
                why += ["cycles are on the other side"] if other else []
                read(page, r"unstable by NUMBER other modes", only=line)
        found.append((line, "; ".join(filter(None, why))))
    for label, name in HOPF_ROWS.items():
        known = [i for i in at if np.isfinite(v[name][i])]
        pairs = rf"( +NUMBER +{NUMBER}(?<=e[-+]\d\d))" * len(known)
        for line, match in read(page, rf"^{re.escape(label)}\S+(?: \S+)?{pairs}$" if known else "(?!)"):
            stated = [match[group].split() for group in range(1, len(match.groups()) + 1, 2)]
            why = [with_error(*cells, v[name][i]) for i, cells in zip(known, stated, strict=True)]
            found.append((line, "; ".join(filter(None, why))))
    return found


OUTCOMES = {
    "cycle": "beats",
    "straight": "stays straight",
    "unstable": "has an unstable cycle",
    "torus": "beats quasiperiodically (two frequencies)",
    "not_settled": "does not settle",
    "left_the_model": "leaves the model",
    "failed": "is not solved",
}
"""What is said of rods, by status."""


def cycle_sentences(view, page, keywords, fine):
    own, shape = view.variables, view.variables["status"].shape
    words = [
        np.array([each.status_flags[int(s)] for s in each.variables["status"].ravel()])
        for each in (view, fine)
    ]
    same = (words[0] == words[1]).reshape(shape)  # next to a Hopf point a motion may take long
    v = {}
    for name in fine.variables:
        exact, stored = np.asarray(fine.variables[name]), np.asarray(own[name])
        if exact.shape == stored.shape:
            beside = (
                same.reshape(shape + (1,) * (exact.ndim - len(shape)))
                if exact.shape[: len(shape)] == shape
                else True
            )
            v[name] = np.where(beside, exact, stored)
    beats = (words[0] == "cycle").reshape(shape)
    found = counts(page, r"^of NUMBER points?: \w", same.size)
    for word in set(words[0]):
        said = re.escape(OUTCOMES.get(word, word.replace("_", " ")))
        where = (words[0] == word, view.point_columns, lambda text, mask: region_as_stated(view, text, mask))
        found += regions(page, rf"(?<=[:,)\d] ){said} at", *where)
        found += counts(page, rf"^the rod {said} at all NUMBER point", same.size)
    w = np.array([leading(rod)[0] for rod in rods_of(view)])
    found += ranges(
        page, "straight rod: leading growth rate RANGE 1/tau2, frequency RANGE rad/tau2", w.real, w.imag
    )
    stays = (words[0] == "straight") & (w.real > 0)
    found += [(page[0], "a rod that stays straight grows")] if stays.any() else []
    found += [(line, "") for line, _ in read(page, r"quasiperiodic motions: .* of RANGE$")]
    if "hopf_lines" in own:
        proved = int(own["hopf_lines_proved"]), int(own["hopf_lines"])
        found += counts(
            page,
            "list of Hopf points between neighbouring points is proved complete for NUMBER of NUMBER line",
            *proved,
        )
    found += _second_states(view, page, w, keywords)
    orbits = np.isin(words[0], ["cycle", "unstable"]).reshape(shape)
    for pattern, name in (
        ("^period", "period"),
        ("^largest y of the tip", "tip_y_max"),
        ("^frequency", "frequency"),
        ("^largest Floquet multiplier", "multiplier"),
    ):
        for line, match in read(page, rf"{pattern} +NUMBER +({NUMBER}(?<=e[-+]\d\d))"):
            found.append((line, with_error(match[1], match[2], float(v[name][orbits].max()))))
    for line, match in read(page, "the cycle is .*multiplier is (above|below) NUMBER"):
        above = float(v["multiplier"][orbits].max()) > 1
        found.append((line, "" if above == (match[1] == "above") else "the verdict is the other"))
    if beats.any():
        of_points = [name for name in v if v[name].shape[: len(shape)] == shape]
        found += _sizes(page, *({name: some[name][beats] for name in of_points} for some in (v, own)))
    return found + threshold_sentences(view, page)


def _sizes(page, v, own):
    """The periods, sizes and powers of the cycles of several points, and their largest errors."""
    found = ranges(page, "^period: RANGE tau2; largest y of the tip: RANGE L", v["period"], v["tip_y_max"])
    found += ranges(page, "^period: RANGE tau1", v["period_tau1"]) if "period_tau1" in v else []
    ratio = v["frequency"] / v["linear_frequency"]
    of_mode = "^frequency of the cycle: RANGE rad/tau2, RANGE times that of the leading mode"
    found += ranges(page, of_mode, v["frequency"], ratio)
    tips = [v[f"tip_{name}"] for name in ("x_min", "x_max", "theta_max")]
    found += ranges(page, "least x RANGE L, largest x RANGE L, largest .theta. RANGE rad", *tips)
    found += ranges(page, r"mean power of the force: RANGE k3", v["injection_mean"])
    rest = r"^largest \|Floquet multiplier\|: RANGE; returns of the tip in the integration: RANGE; "
    rest += "smallest stretch h1: RANGE"
    without = np.isnan(own["multiplier"])  # time integration computes none
    multiplier = np.where(without, np.nan, v["multiplier"])
    found += ranges(page, rest, multiplier, own["periods"], v["least_stretch"])
    extrema = max(
        float(np.nanmax(np.abs(own[n] - v[n]) / v["tip_y_max"]))
        for n in ("tip_x_min", "tip_x_max", "tip_theta_max")
    )
    worst = (
        relative(own["period"], v["period"]),
        relative(own["tip_y_max"], v["tip_y_max"]),
        extrema,
        0.0,
    )
    pattern = "^worst errors: period NUMBER, largest y of the tip NUMBER, other extrema of the tip NUMBER, "
    pattern += "energy balance NUMBER, "
    found += at_most(page, f"{pattern}multiplier not known" if without.all() else pattern, *worst)
    if not without.all():
        off = float(np.nanmax(np.abs(own["multiplier"] - v["multiplier"])))
        found += at_most(page, "^worst errors: .*, multiplier NUMBER", off)
    stretch, error = own["least_stretch"], own["extrema_error"] * own["tip_y_max"]
    beyond = np.abs(stretch - v["least_stretch"]) > error + BETWEEN_NODES * np.abs(1 - stretch)
    found += [(page[0], "the least stretch is off by more than its error")] * bool(beyond.any())
    balance = float(np.nanmax(np.abs(own["injection_mean"] / own["dissipation_mean"] - 1)))
    return found + at_most(page, "energy balance NUMBER", balance)


def _second_states(view, page, w, keywords):
    """Whether straight rods are stable where they are said to be, and Hopf points subcritical."""
    own, columns, found = view.variables, view.point_columns, []
    ends_stable = np.isin(view.status_names, ("cycle", "torus"))
    for pattern, settled in (
        ("^two stable states(?: at NUMBER of NUMBER points?)?: the straight rod", ends_stable),
        ("^the straight rod is stable(?: at NUMBER of NUMBER points?)? where the motion", ~ends_stable),
    ):
        straight = (own["second_state"] == 1).ravel() & settled.ravel()
        for line, match in read(page, pattern):
            right = match[1] is None or int(match[1]) == straight.sum()
            why = [] if right else [f"at {straight.sum()} points"]
            found.append((line, "; ".join(why + ["it grows"] * bool((w.real[straight] > 0).any()))))
    possible = (own["second_state"] == 2).ravel()
    for line, match in read(
        page,
        "^a stable cycle may exist beside the straight rod(?: at NUMBER of NUMBER points?)?: "
        ".* at F = RANGE is subcritical",
    ):
        why = [] if match[1] is None or int(match[1]) == possible.sum() else [f"at {possible.sum()} points"]
        at = []
        for i in np.flatnonzero(possible):
            rod = {name: float(columns[name][i]) for name in ("k1", "k2", "gamma3", "gamma1")}
            F = float(own["subcritical_F"].ravel()[i])
            data = rs.sweep("criticality", **rod, F_max=min(1.01 * F, 0.9999 * rod["k1"]), progress=False)
            near = int(np.nanargmin(np.abs(data.crossing_F.values.ravel() - F)))
            at.append(float(data.crossing_F.values.ravel()[near]))
            why += [] if data.criticality.values.ravel()[near] == 1 else [f"F = {F} is not subcritical"]
        found.append((line, "; ".join(filter(None, [*why, range_as_stated(match[3], at)]))))
    return found


CHANGES_OF_CYCLES = {
    "folds of cycles": 2,
    "torus points of cycles": 3,
    "symmetry breakings of cycles": 4,
    "cycles that crush a section of the rod": 5,
}


def diagram_sentences(view, page, keywords, fine):
    line, row = "F", next(name for name in view.parameters if len(view.parameter_values[name]) > 1)
    v, values, rows = view.variables, view.variables[line], view.parameter_values[row]
    fixed = {
        name: float(view.parameter_values[name][0])
        for name in view.parameters
        if name in NON_OPTIONAL_LINEAR_PARAMETER_NAMES
    }
    every, table = [], []
    for value in rows:
        rod = Rod(F=0.0, **fixed | {row: float(value)})
        stop = min(float(values[-1]), rod.k1 * SHORT_OF_CRUSHED)
        every.append(changes_along(rod, "F", float(values[0]), stop))
        table.append([_class_of(replace(rod, F=float(F))) if rod.k1 > F else "crushed" for F in values])
    table = np.array(table)
    found = _search_sentences(view, page, every, "row")
    found += counts(page, "^of NUMBER grid points on the rows", table.size)
    found += ranges(page, "where the rows begin: .* of RANGE rows?", [len(rows)])
    found += ranges(page, "^the straight rod at F = RANGE, where the rows begin", [values[0]])
    for word in ("monotone", "oscillatory", "flutter", "crushed"):
        there = table == word
        share = rf"^behaviour of the straight rod, in % of the grid points:.*?RANGE % {word}"
        found += ranges(page, share, [100 * there.mean()])
        found += counts(page, rf"^of \d+ grid points on the rows:.*?NUMBER {word}", there.sum())
        found += counts(page, rf"where the rows begin.*: .*{word} on NUMBER", there[:, 0].sum())
    beats = (table == "flutter").any(axis=1)
    # A window of flutter between two grid points begins with a Hopf point.
    beats |= [any(c.kind.name == "hopf" for c in each) for each in every]
    numbers = beats.sum(), len(rows), (~beats).sum()
    found += counts(page, r"^flutter: on NUMBER of NUMBER rows?, .*; none on NUMBER", *numbers)
    found += ranges(
        page,
        rf"^flutter: on \d+ of \d+ rows?, {row} = RANGE; none on \d+, {row} = RANGE",
        rows[beats],
        rows[~beats],
    )
    for kind in ("onset", "hopf", "restabilization", "real_again", "hopf_reverse"):
        of_kind = [[c.value for c in each if c.kind.name == kind] for each in every]
        having = np.array([bool(each) for each in of_kind])
        first = [each[0] for each in of_kind if each]
        again = [at for each in of_kind for at in each[1:]]
        start = rf"^{kind}(?: [^:]*)?"
        found += counts(page, rf"{start}: on NUMBER of NUMBER row", having.sum(), len(rows))
        if having.any():
            found += ranges(
                page, rf"{start}: on \d+ of \d+ rows?, F = RANGE, {row} = RANGE", first, rows[having]
            )
            repeated = sum(len(each) > 1 for each in of_kind)
            found += ranges(
                page, rf"{start}: .*; again further along the row on \d+ of these rows, at F = RANGE", again
            )
            found += counts(
                page, rf"{start}: .*; again further along the row on NUMBER of these rows", repeated
            )
    found += _curve_sentences(view, page, row)
    if "stable_states" in v:
        found += _state_sentences(view, page, _states_of(view, row, fixed, table), row)
    return found


def _class_of(rod):
    """What a straight rod does."""
    w = leading(rod)[0]
    return "flutter" if w.real > 0 else "oscillatory" if w.imag else "monotone"


def _curve_sentences(view, page, row):
    """The boundaries that are followed through rows: their number, folds, and that they are boundaries."""
    v = view.variables
    if "curve_number" not in v:
        return []
    kinds = [int(v["curve_kind"][v["curve_number"] == n][0]) for n in np.unique(v["curve_number"])]
    for_line = "^curves: NUMBER of Hopf points, NUMBER of double eigenvalues; "
    for_line += "the crossings located on rows lie within NUMBER of the range of F from the curves; "
    for_line += "(?:every crossing is on a|NUMBER crossings? (?:is|are) on no) curve"
    found = []
    for line, match in read(page, for_line):
        told = [int(match[1]), int(match[2]), int(match[4] or 0)]
        true = [sum(k == 1 for k in kinds), sum(k == 0 for k in kinds), int(v["curves_untraced"])]
        why = [] if told == true else [f"it is {true}"]
        why += (
            [] if abs(float(v["curve_agreement"]) - float(match[3])) <= unit_of(match[3]) else ["agreement"]
        )
        found.append((line, "; ".join(why)))
    cut = rf"^curve NUMBER, of [a-zA-Z ]+, is incomplete: it stops at {row} = NUMBER, F = NUMBER:"
    for line, match in read(page, cut):
        here = v["curve_number"] == int(match[1])
        off = [np.abs(v[f"curve_{n}"][here][[0, -1]] - float(match[i])) for n, i in ((row, 2), ("F", 3))]
        near = (off[0] <= unit_of(match[2])) & (off[1] <= unit_of(match[3]))
        found.append((line, "" if near.any() else "the curve does not end there"))
    fixed = {name: float(view.parameter_values[name][0]) for name in view.parameters if name != row}
    for i in range(0, len(v["curve_kind"]), max(1, len(v["curve_kind"]) // 6)):
        rod = Rod(F=float(v["curve_F"][i]), **fixed | {row: float(v[f"curve_{row}"][i])})
        w = solve_spectrum(rod, SpectrumRequest(MANY, 1e-10, False)).eigenvalues
        at = complex(v["curve_growth_rate"][i], v["curve_frequency"][i])
        off = np.sort(np.abs(w - at))[0] / abs(at)
        # Double eigenvalues move with the root of an error.
        found.append(
            (
                page[0],
                ""
                if off < (1e-6 if v["curve_kind"][i] else 1e-4)
                else f"point {i} of a curve is off by {off}",
            )
        )
    for line, match in read(
        page,
        rf"^fold of the curve of (\w+ \w+), where (\w+) is extremal: "
        rf"{row} = NUMBER(?: \(\+- NUMBER\))?, F = NUMBER(?: \(\+- NUMBER\))?",
    ):
        found.append((line, _fold(match, row, fixed, {row: float(match[3]), "F": float(match[5])})))
    if "partial_beam_k1" in v:
        filament = rs.Rod(k1=np.inf, k2=np.inf, gamma3=0.0).thresholds(F_max=60).F_hopf
        found += ranges(
            page, "k1 = RANGE Fc = RANGE, F = RANGE Fc = RANGE$", [4], [4 * filament], [2], [2 * filament]
        )
    found += [
        (line, "")
        for line, _ in read(page, r"^criticality, gamma1 = NUMBER: of NUMBER points? of the Hopf curves ")
    ]
    for line, match in read(page, r"of (\d+) points? of the Hopf curves (.*)$"):
        told = sum(int(n) for n in re.findall(r"(\d+) (?:super|sub|undecided|without)", match[2]))
        found.append((line, "" if told == int(match[1]) else "parts are not the whole"))
        found.append((line, _side_of_points(view, row, fixed)))
    for line, match in read(
        page,
        r"^generalised Hopf point \(Re c = NUMBER\) on curve NUMBER: "
        rf"{row} = NUMBER \(\+- NUMBER\), F = NUMBER \(\+- NUMBER\)",
    ):
        found.append((line, _bautin(view, row, fixed, float(match[3]), float(match[5]))))
    return found


def _fold(match, row, fixed, place):
    """Why a curve has no fold at a place: beside it the number of changes differs on both sides."""
    name = match[2]
    other = "F" if name == row else row
    changes = []
    for side in (-1, 1):
        rod = Rod(**({"F": place["F"]} | fixed | {row: place[row]}))
        rod = replace(rod, **{name: place[name] * (1 + side * FOLD_BESIDE)})
        low, high = (place[other] * (1 + s * FOLD_WIDTH) for s in (-1, 1))
        if not (rod.k1 > rod.F and (other != "k1" or low > rod.F) and (other != "F" or high < rod.k1)):
            return ""
        kinds = (
            ("onset", "real_again")
            if match[1].startswith("double")
            else ("hopf", "hopf_reverse", "restabilization")
        )
        changes.append(sum(c.kind.name in kinds for c in changes_along(rod, other, low, high)))
    return "" if abs(changes[0] - changes[1]) == 2 else f"changes on both sides: {changes}"


def _normal_form_at(view, row, fixed, value, F):
    """The sign of Re c of the Hopf point next to a place of the plane."""
    gamma1 = float(view.variables["curve_gamma1"])
    rod = fixed | {row: value, "gamma1": gamma1}
    data = rs.sweep("criticality", **rod, F_max=min(1.001 * F, 0.99999 * rod["k1"]), progress=False)
    near = int(np.nanargmin(np.abs(data.crossing_F.values.ravel() - F)))
    return float(data.criticality.values.ravel()[near])


def _side_of_points(view, row, fixed):
    """Why some Hopf points of curves are born on the other side than is stored."""
    v = view.variables
    there = np.flatnonzero(
        (v["curve_kind"] == 1)
        & np.isfinite(v["curve_criticality"])
        & (v["curve_F"] < 0.99 * _k1(v, fixed, row))
    )
    for i in there[:: max(1, len(there) // 4)]:
        side = _normal_form_at(view, row, fixed, float(v[f"curve_{row}"][i]), float(v["curve_F"][i]))
        if side != v["curve_criticality"][i]:
            return f"point {i} is on side {side}"
    return ""


def _k1(v, fixed, row):
    return v["curve_k1"] if row == "k1" else fixed["k1"]


def _bautin(view, row, fixed, value, F):
    """Why the side does not change at a generalised Hopf point: beside it, along its curve."""
    v = view.variables
    on = np.flatnonzero(v["curve_kind"] == 1)
    i = on[np.argsort(np.hypot(v[f"curve_{row}"][on] / value - 1, v["curve_F"][on] / F - 1))[:6]]
    sides = {float(side) for side in v["curve_criticality"][i]}
    return "" if {-1.0, 1.0} <= sides else f"sides near by: {sides}"


def _states_of(view, row, fixed, table):
    """What is stable at the points of a diagram, and the special points of its rows, from branches of rods.

    table: what the straight rod does, (rows, values). Rows with branches that no Hopf point leads to are as
    in the file: the branches of a rod lack them.
    """
    F, gamma1 = view.variables["F"], float(view.attributes.get("gamma1", 1.0))
    states, kinds, at = [], [], []
    own = [
        view.flattened_by_point(name) for name in ("stable_states", "cycle_special_kind", "cycle_special_F")
    ]
    for value, motions in zip(view.parameter_values[row], table, strict=True):
        if value in _detached(view, row):
            number = list(view.parameter_values[row]).index(value)
            for found, values in zip((states, kinds, at), own, strict=True):
                found.append(values[number])
            continue
        rod = {**fixed, row: float(value), "gamma1": gamma1, "stop": float(F[-1])}
        branch = solved("branch", rod | {"accuracy": FINE["branch"]})
        ranges_ = [piece for curve in RodBranches(branch).curves for piece in curve.stable_ranges]
        cycles = np.array([any(a < x < b * (1 + TIE) for a, b in ranges_) for x in F])
        straight = np.isin(motions, ["monotone", "oscillatory"])
        states.append(np.where(motions == "crushed", 5, straight + 2 * cycles))
        kinds.append(branch.variables["special_kind"].ravel())
        at.append(branch.variables["special_at"].ravel())
    return {
        "F": F,
        "stable_states": np.array(states),
        "cycle_special_kind": np.array(kinds),
        "cycle_special_F": np.array(at),
    }


def _detached(view, row):
    """Values of the rows with branches that no Hopf point leads to."""
    numbers = view.variables.get("cycle_detached_row", [])
    return [float(view.point_columns[row][number - 1]) for number in numbers]


STABLE_STATES = (
    "no stable state known",
    "straight rod only",
    "cycle only",
    "straight rod and cycle",
    "undecided",
    "crushed",
)
"""What is said of stable states, by their stored number."""


def _state_sentences(view, page, fine, row):
    """Stable states and special points of cycles, against branches of a far smaller accuracy."""
    v, rows, found = fine, view.parameter_values[row], []
    states = v["stable_states"]
    found += followed_beyond(view, page, "cycle_followed_", view.variables["F"][[0, -1]])
    for number, word in enumerate(STABLE_STATES):
        share = [100 * (states == number).mean()]
        found += ranges(
            page, rf"^stable states, in % of the grid points: (?:.*, )?RANGE % {word}(?:,|$)", share
        )
    both = (states == 3).any(axis=1)
    kinds, at = v["cycle_special_kind"], v["cycle_special_F"]
    where = {
        r"straight rod and cycle both stable": (both, np.broadcast_to(v["F"], states.shape)[states == 3])
    }
    none = states == 0
    where["no stable state known"] = none.any(axis=1), np.broadcast_to(v["F"], none.shape)[none]
    own = view.variables["stable_states"] == 4  # a smaller accuracy may decide them
    where["stable states undecided"] = own.any(axis=1), np.broadcast_to(v["F"], own.shape)[own]
    for words, kind in CHANGES_OF_CYCLES.items():
        where[words] = (kinds == kind).any(axis=1), at[kinds == kind]
    for words, (there, places) in where.items():
        on = "at grid points of" if "stable" in words else "on"
        found += counts(page, rf"^{words}: {on} NUMBER of NUMBER row", there.sum(), len(rows))
        if there.any():
            found += ranges(
                page, rf"^{words}: {on} \d+ of \d+ rows?, F = RANGE, {row} = RANGE", places, rows[there]
            )
    hidden = rf"^straight rod and cycle both stable: only between grid points on NUMBER rows?, {row} = RANGE"
    for line, match in read(page, hidden):
        # Such a row has a Hopf point and a special point of cycles between two neighbouring grid points.
        hopfs, specials = (
            np.apply_along_axis(lambda x: np.histogram(x[np.isfinite(x)], v["F"])[0], 1, places)
            for places in (np.where(kinds == 1, at, np.nan), np.where(kinds > 1, at, np.nan))
        )
        possible = ~both & ((hopfs > 0) & (specials > 0)).any(axis=1)
        right = 0 < int(match.group(1)) <= possible.sum()
        found.append((line, "" if right else f"{possible.sum()} rows have both changes in an interval"))
    for line, match in read(
        page,
        rf"^curve of (folds|torus points) of cycles: "
        rf"from {row} = NUMBER, F = NUMBER \(\+- ({NUMBER})\) \([^)]*\) "
        rf"to {row} = NUMBER, F = NUMBER \(\+- ({NUMBER})\) \([^)]*\); NUMBER points?, "
        "largest error of F NUMBER",
    ):
        places = ((float(match[2 + k]), match[3 + k], match[4 + k]) for k in (0, 3))
        why = (_special_on_branch(view, row, match[1], *place) for place in places)
        found.append((line, "; ".join(filter(None, why))))
    for line, match in read(
        page,
        rf"^extremum of {row} along curve NUMBER of folds of cycles: "
        rf"{row} = NUMBER \(\+- NUMBER\), F = NUMBER",
    ):
        found.append((line, _extremum_on_curve(view, row, int(match[1]), float(match[2]), float(match[4]))))
    detached = _detached(view, row)
    pattern = "^branches that no Hopf point of their row leads to: on NUMBER of NUMBER row"
    found += counts(page, pattern, len(detached), len(rows))
    if detached:
        found += ranges(page, rf"^branches that .*: on \d+ of \d+ rows?, {row} = RANGE", detached)
    for name, pattern in (
        ("cycle_curves_lost_beyond", "ends of curves of folds lost beyond the range: NUMBER;"),
        ("cycle_extrema_unlocated", f"extrema of {row} along curves .* that could not be located: NUMBER;"),
    ):
        found += counts(page, f"^{pattern}", int(view.variables.get(name, 0)))
    for line, match in read(
        page, rf"^this curve crosses the row {row} = NUMBER between F = NUMBER and NUMBER, but no branch"
    ):
        found.append((line, _special_on_row(view, row, *map(float, match.groups()))))
    for line, match in read(
        page,
        "^curves of folds and torus points of cycles: NUMBER; the points located on rows lie within NUMBER "
        "of the range of F from the curves; (?:every|NUMBER) fold",
    ):
        true = (
            len(np.unique(view.variables["cycle_curve_number"])),
            int(view.variables["cycle_curves_untraced"]),
        )
        found.append((line, "" if (int(match[1]), int(match[3] or 0)) == true else f"it is {true}"))
    return found


def _extremum_on_curve(view, row, number, value, F):
    """Why a point of a curve of folds is no extremum of the row parameter."""
    v = view.variables
    points = v["cycle_curve_number"] == number
    across, along = v[f"cycle_curve_{row}"][points], v["cycle_curve_F"][points]
    here = int(np.argmin(np.abs(along - F) + np.abs(across - value)))
    if not 0 < here < len(across) - 1:
        return "the curve has no two neighbours of this point"
    sides = across[[here - 1, here + 1]] - value
    return "" if sides[0] * sides[1] > 0 else f"{row} changes by {sides} to the neighbours"


def _special_on_row(view, row, value, low, high):
    """Why a row has a fold or a torus point between two forces where it is said to have none."""
    rod = {name: float(view.parameter_values[name][0]) for name in view.parameters} | {row: value}
    rod["gamma1"] = float(view.attributes.get("gamma1", 1.0))
    data = rs.sweep("branch", **rod, stop=min(1.05 * high, 0.9998 * rod["k1"]), accuracy=1e-7, progress=False)
    kinds, at = data.special_kind.values.ravel(), data.special_at.values.ravel()
    there = at[np.isin(kinds, (2, 3))]
    found = there[(there >= low) & (there <= high)]
    return f"the branch of {row} = {value} has one at {found}" if len(found) else ""


def _special_on_branch(view, row, kind, value, F, error):
    """Why a point of a curve of special points of cycles is none on the branch of its rod."""
    if any(abs(value / one - 1) < 1e-8 for one in _detached(view, row)):
        return ""  # the branches of a rod lack this one
    rod = {name: float(view.parameter_values[name][0]) for name in view.parameters} | {row: value}
    rod["gamma1"] = float(view.attributes.get("gamma1", 1.0))
    top = min(1.05 * float(F), 0.9998 * rod["k1"])
    data = rs.sweep("branch", **rod, stop=top, accuracy=1e-7, progress=False)
    kinds, at = data.special_kind.values.ravel(), data.special_at.values.ravel()
    there = at[kinds == (2 if kind == "folds" else 3)]
    there = np.append(there, at[kinds == 1])  # curves end at Hopf points
    near = min(there, key=lambda place: abs(place - float(F)), default=inf)
    # The row of the end is known to nine digits only.
    return (
        "" if abs(near - float(F)) <= float(error) + 1e-6 * near else f"{F} +- {error} at {value} is {near}"
    )


CHECKS = {
    "spectrum": spectrum_sentences,
    "modes": modes_sentences,
    "thresholds": thresholds_sentences,
    "criticality": criticality_sentences,
    "limit_cycle": cycle_sentences,
    "phase_diagram": diagram_sentences,
    "branch": branch_sentences,
}
