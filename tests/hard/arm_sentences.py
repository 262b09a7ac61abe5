"""What is said of arms in their own units, on the page of `show` and in the report of `rodsweep arm`.

Scales are computed here anew from the quantities of the arm: section, drag of a slender cylinder (Cox 1970,
Gray and Hancock 1955, Lighthill 1976), k3/L^2 and tau2. Thresholds are those of the covering for every drag.
"""

import re
from math import floor, inf, log, log10, pi

import numpy as np
from rods import rod_of

import rodsweep as rs
from rodsweep.model.arm.arm import SlenderArm
from rodsweep.model.arm.drag import DRAG_ESTIMATE_NAMES
from rodsweep.model.arm.neglected import (
    CURVATURE_OVER_AMPLITUDE,
    DOUBTFUL_RATIO,
    LARGE_AMPLITUDE,
    Validity,
    angular_frequency_at_smallest_drag,
    neglected_effects,
    worst_validity,
)
from rodsweep.model.rod import Rod
from rodsweep.solve.cycle.status import CycleStatus

from .page import NUMBER, Page, as_stated, parameter_lines, range_as_stated, read
from .truths import changes_on_lines, changes_over_force, leading, rods_of, time_is_known

PREFIXES = {"p": 1e-12, "n": 1e-9, "µ": 1e-6, "m": 1e-3, "c": 1e-2, "": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}
BASES = ("Pa s", "Pa", "N m^2", "N", "Hz", "1/s", "s", "m^2", "m^4", "m", "J", "W", "kg/m^3")
UNITS_AND_EXAMPLES = {f"{p}{base}": factor for base in BASES for p, factor in PREFIXES.items()} | {
    "P": 0.1,
    "1/s": 1.0,
}
UNITS_AND_EXAMPLES |= {"m^2": 1.0, "mm": 1e-3, "g/cm^3": 1e3}
UNIT = "|".join(sorted(map(re.escape, UNITS_AND_EXAMPLES), key=len, reverse=True))
SIDES = ("radius", "inner_radius", "width", "height")
LOAD_NAMES = ("pressure", "force")
WITHOUT_CYCLE = {
    "straight": "does not beat",
    "unstable": "has an unstable cycle",
    "torus": "beats quasiperiodically (two frequencies)",
    "not_settled": "is not settled: no stable cycle was found, but a stable cycle may exist",
    "left_the_model": "is crushed somewhere or loses its stiffness, where the model ends",
    "failed": "is not known: the solve failed",
}
"""What is said of arms of which none beats, by status."""
SAID = {
    "flutter begins at": "hopf",
    "the straight arm is stable again from": "restabilization",
    "decaying disturbances start to oscillate at": "onset",
}
NAMED = {"Young's modulus": "young", "Poisson's ratio": "poisson"}
EQUAL_LOADS = 1e-12
"""Relative difference of loads that are one."""
TWO_DIGITS = 0.06
"""Relative difference that two digits leave."""


POINTS = r"(?: (?:at|on) (?:all )?NUMBER (?:of NUMBER )?(?:points?|rows?))?"
JUDGED = (
    r"(?P<judged>, judged at the first Hopf point(?: of each row)?"
    r"(?:, and at rest without load on NUMBER rows? without)?|, judged at rest without load)?"
)


def random_arm(random, load=True, varied=False):
    """Quantities of an arm with units; some of them in a list of three where varied."""
    radius = 10 ** random.uniform(-3.3, -1.9)
    arm = {"length": _cm(radius * random.uniform(14, 60)), "young": f"{10 ** random.uniform(1, 3):.4g} kPa"}
    shape = random.choice(["circle", "circle", "tube", "rectangle"])
    if shape == "rectangle":
        arm |= {"width": _cm(radius * random.uniform(1, 2)), "height": _cm(radius * random.uniform(1, 2))}
    else:
        arm |= {"radius": _cm(radius)}
        arm |= {"inner_radius": _cm(radius * random.uniform(0.1, 0.6))} if shape == "tube" else {}
    arm |= {
        "poisson": round(random.uniform(0.2, 0.5), 2),
        "viscosity": f"{10 ** random.uniform(-3, 3):.4g} Pa s",
    }
    arm |= {"density_difference": f"{random.uniform(-5, 100):.3g} kg/m^3"} if random.random() < 0.3 else {}
    if varied:
        name = str(random.choice([n for n in ("length", "young", "viscosity") if n in arm]))
        value, unit = arm[name].split(" ", 1)
        arm[name] = [f"{float(value) * factor:.6g} {unit}" for factor in (1.0, 1.15, 1.4)]
    if load:
        first = SlenderArm(
            **{name: value[0] if isinstance(value, list) else value for name, value in arm.items()}
        )
        top = min(first.load_scale * 10 ** random.uniform(1.2, 2), 0.4 * first.k1 * first.load_scale)
        arm["pressure"] = f"{top / 1e3:.5g} kPa"
    return arm


def _cm(metres):
    return f"{100 * metres:.4g} cm"


# --- scales ---


def section_of(q):
    """(area, second moment, area of the tip's face, radius of equal drag, half the height), SI."""
    if "radius" in q:
        a, b = q["radius"], q.get("inner_radius", 0.0)
        return pi * (a**2 - b**2), pi * (a**4 - b**4) / 4, pi * a**2, a, a
    w, h = q["width"], q["height"]
    return w * h, w * h**3 / 12, w * h, (w + h) / 4, h / 2


def drags_of(q):
    """(gamma1, gamma2, gamma3) of the likeliest drag, then of the corners of its range, SI."""
    *_, a, half = section_of(q)
    eta, s = q["viscosity"], q["length"] / a
    along = [(log(2 * s) - 1.5, log(2 * s) - 0.5), (log(8 * s) - 0.5, log(8 * s) + 0.5)]
    along.append((log(0.18 * s), log(0.18 * s) + 0.5))
    turning = [pi * eta * half**2, 4 * pi * eta * half**2]
    pairs = [(2 * pi * eta / x, 4 * pi * eta / y) for x, y in along]
    return [(*pairs[0], (turning[0] * turning[1]) ** 0.5)] + [(*p, t) for p in pairs[1:] for t in turning]


def scales_of(q):
    """Units of an arm whose quantities are numbers in SI: tau2, force_scale, pressure_scale, length."""
    _, moment, face, *_ = section_of(q)
    force = q["young"] * moment / q["length"] ** 2
    tau2 = drags_of(q)[int(q.get("drag", 0))][1] * q["length"] ** 4 / (q["young"] * moment)
    return {"tau2": tau2, "force_scale": force, "pressure_scale": force / face, "length": q["length"]}


def quantities_at_points(view):
    """Quantities of the arm at every point of a file, numbers in SI."""
    count = len(rods_of(view)) if "F" in view.point_columns else view.variables["status"].size
    given = {
        name: np.broadcast_to(np.asarray(values, float).ravel(), count)
        for name, values in view.quantities.items()
        if name not in ("tau2", "force_scale", "pressure_scale") and np.size(values) in (1, count)
    }
    return [{name: float(values[i]) for name, values in given.items()} for i in range(count)]


def arm_of(q):
    """The arm of quantities at a point."""
    given = {n: x for n, x in q.items() if not np.isnan(x) and n != "drag" and not n.endswith("over_flutter")}
    return SlenderArm(**given, drag=DRAG_ESTIMATE_NAMES[int(q.get("drag", 0))])


def in_si(view):
    """Units of the arm at every point, by name, each (points,)."""
    each = [scales_of(q) for q in quantities_at_points(view)]
    return {name: np.array([scales[name] for scales in each]) for name in each[0]}


def force_unit(view):
    return "force_scale" if "force" in view.quantities else "pressure_scale"


# --- the page of a sweep ---


def arm_sentences(view, page, fine):
    """The check of every line in its own units of a sweep of an arm."""
    scales = in_si(view)
    found = _quantity_lines(view, page) + _validity_line(view, page, fine)
    for line in page:
        if line.startswith("in the arm's units: "):
            found += [_item(view, page, line, match, fine, scales) for match in _items(line)]
    return found + _thresholds(view, page, scales) + _answer(view, page, fine, scales)


def _quantity_lines(view, page):
    """The table of quantities in the units in which they were typed."""
    found = []
    for name, values in view.quantities.items():
        true = np.unique(np.asarray(values, float))
        if name == "drag":
            found += _drag_line(page, [DRAG_ESTIMATE_NAMES[int(number)] for number in true])
            continue
        for line, why, low, high, unit in parameter_lines(page, name, true):
            ends = (
                as_stated(low, true.min() / UNITS_AND_EXAMPLES.get(unit, 1.0)),
                as_stated(high, true.max() / UNITS_AND_EXAMPLES.get(unit, 1.0)),
            )
            found.append((line, "; ".join(filter(None, (why, *ends)))))
    return found


def _drag_line(page, names):
    """The row of the drags: their number, the first and the last name."""
    counted = "NUMBER +" * any(re.match("parameter +values", line) is not None for line in page)
    ends = " +".join(dict.fromkeys([names[0], names[-1]]))
    found = []
    for line, match in read(page, rf"^drag +{counted}(.*?) *$"):
        right = re.fullmatch(ends, match.groups()[-1].strip())
        right = right and (not counted or int(match[1]) == len(names))
        found.append((line, "" if right else f"the drags are {names}"))
    return found


def _items(line):
    return re.finditer(rf"(\w+) = ({NUMBER}(?:(?:, | to ){NUMBER})*) ({UNIT})(?=;|$)", line)


def _item(view, page, line, match, fine, scales):
    """An item of what is said of a whole file, such as "period = 1 to 2 s"."""
    page.mark(line, match.span(2))
    name, text, unit = match.groups()
    base = UNITS_AND_EXAMPLES[unit]
    event = re.fullmatch(r"frequency_(hopf|restabilization)", name)
    name = (
        f"{event[1]}_frequency"
        if event
        else "_".join("F" if word in LOAD_NAMES else word for word in name.split("_"))
    )
    stored_there = name in view.variables and view.task == "branch" and not name.startswith("special")
    values = np.asarray((view if stored_there else fine).variables[name], float)  # its cycles are elsewhere
    if name == "transient_time":
        values = np.where((view.variables[name] == 0) | time_is_known(view), values, np.nan)
    scale = {"Pa": scales[force_unit(view)], "N": scales[force_unit(view)], "s": scales["tau2"]}
    scale |= {"1/s": 1 / scales["tau2"], "Hz": 1 / (2 * pi * scales["tau2"]), "m": scales["length"]}
    scale |= {"J": scales["force_scale"] * scales["length"]}
    scale |= {"W": scale["J"] / scales["tau2"]}
    of = next(known for known in ("Pa", "Hz", "1/s", "N", "m", "J", "W", "s") if unit.endswith(known))
    values = values.reshape(len(scale[of]), -1) * scale[of][:, None] / base
    values = values[np.isfinite(values)]
    if ", " in text:
        each = text.split(", ")
        if len(each) != len(values):
            return line, f"{name} has {len(values)} values"
        return line, "; ".join(filter(None, map(as_stated, each, values)))
    why = range_as_stated(text, values)
    return line, f"{name}: {why}" if why else ""


def _thresholds(view, page, scales):
    """The check of the loads at which straight arms change, between the points of a file or on its rods."""
    to_load, to_hertz, found = scales[force_unit(view)], 1 / (2 * pi * scales["tau2"]), []
    value = rf"RANGE ({UNIT})"
    if view.task in ("spectrum", "modes", "limit_cycle"):
        changes = changes_on_lines(view, "F")
        for start, kind in SAID.items():
            of_kind = [(c, i) for _, c, at in changes if c.kind.name == kind for i in at]
            loads = [c.value * to_load[i] for c, i in of_kind]
            hertz = [c.frequency * to_hertz[i] for c, i in of_kind]
            pattern = rf"^{start} {value}(?: on)?(?:, where the arm begins to beat at {value})?$"
            found += [(line, _in_units(match.groups(), loads, hertz)) for line, match in read(page, pattern)]
        return found
    if view.task == "branch":
        return found
    rods = _rods_without_load(view)
    every = [changes_over_force(rod, top) for rod, top in zip(rods, _tops(view), strict=True)]
    for line, match in read(page, rf"^(\w+) at {value}: .*?(?:; frequency {value})?$"):
        unit = UNITS_AND_EXAMPLES[match[3]]
        near = min(every[0], key=lambda c: abs(c.value * to_load[0] / unit - float(match[2])))
        why = _in_units(match.groups()[1:], [near.value * to_load[0]], [near.frequency * to_hertz[0]])
        found.append((line, why if near.kind.name == match[1] else f"it is {near.kind.name}"))
    for line, match in read(page, rf"^(\w+): on (?:all )?NUMBER (?:of NUMBER )?rows?, at {value}$"):
        of_kind = [
            [c.value * to_load[i] for c in each if c.kind.name == match[1]] for i, each in enumerate(every)
        ]
        having = sum(map(bool, of_kind))
        why = [] if (int(match[2]), int(match[3] or having)) == (having, len(rods)) else [f"on {having}"]
        why.append(_in_units(match.groups()[3:], sum(of_kind, [])))
        found.append((line, "; ".join(filter(None, why))))
    return found


def _in_units(groups, *true):
    """Why ranges with their units, texts one after another, are not those of arrays in SI."""
    pairs = zip(groups[::2], groups[1::2], true, strict=False)
    return "; ".join(
        filter(
            None, (range_as_stated(t, np.asarray(x) / UNITS_AND_EXAMPLES[unit]) for t, unit, x in pairs if t)
        )
    )


def _rods_without_load(view):
    """The rod of every point, or row, at F = 0."""
    columns = [np.asarray(view.point_columns[name], float) for name in ("k1", "k2", "gamma3")]
    return [rod_of(0.0, *map(float, each)) for each in zip(*columns, strict=True)]


def _tops(view):
    """Up to which force changes are searched, of every rod."""
    if view.task == "phase_diagram":
        return [float(view.variables["F"][-1])] * view.variables["status"].size
    return view.variables["F_end"].ravel().tolist()


def _first(view, scales, kind):
    """(load, frequency in Hz) of the first change of a kind of every rod of a file, nan without."""
    found = []
    for i, (rod, top) in enumerate(zip(_rods_without_load(view), _tops(view), strict=True)):
        first = next((c for c in changes_over_force(rod, top) if c.kind.name == kind), None)
        to_hertz = 1 / (2 * pi * scales["tau2"][i])
        nothing = (np.nan, np.nan)
        found.append(
            (first.value * scales[force_unit(view)][i], first.frequency * to_hertz) if first else nothing
        )
    return np.array(found).T


# --- quantities of arms where something happens, and the range of drag ---


def varied_quantities(view):
    """The quantities of arms that differ among the points of a file, each (points,)."""
    each = quantities_at_points(view)
    names = [name for name in each[0] if len({q[name] for q in each}) > 1]
    return {name: np.array([q[name] for q in each]) for name in names}


def region_as_stated(view, text, mask):
    """Why a text such as "Young's modulus 162 to 227 kPa, drag most" is not the region of points, a mask."""
    columns, why, told = varied_quantities(view), [], set()
    for item in text.split(", "):
        if match := re.fullmatch(r"drag (.*)", item):
            name = "drag"
            names = {DRAG_ESTIMATE_NAMES[int(x)].replace("_", " ") for x in columns[name][mask]}
            why += [] if set(match[1].split(" and ")) == names else [f"drags {names}"]
        elif match := re.fullmatch(rf"({NUMBER}(?: to {NUMBER})?) of flutter", item):
            name = next(name for name in columns if name.endswith("over_flutter"))
            why.append(range_as_stated(match[1], columns[name][mask]))
        elif match := re.fullmatch(rf"(.*?) ({NUMBER}(?: to {NUMBER})?)(?: (\S.*))?", item):
            name = NAMED.get(match[1], match[1].replace(" ", "_"))
            why.append(range_as_stated(match[2], columns[name][mask] / UNITS_AND_EXAMPLES.get(match[3], 1.0)))
        else:
            return f"nothing reads {item}"
        told.add(name)
    whole = "drag" in columns and set(columns["drag"][mask]) == set(columns["drag"])
    left = {n for n in columns if not n.startswith(LOAD_NAMES) or n + "_over_flutter" not in columns} - told
    left -= {"drag"} if whole else set()
    return "; ".join(filter(None, [*why, f"{sorted(left)} are left out" if left else ""]))


def _alike_but_for_drag(view):
    """A number for each point, equal where the same arm has the same load, whatever its drag."""
    columns = varied_quantities(view)
    columns.pop("drag", None)
    load = [name for name in columns if name.endswith("over_flutter")]
    names = [name for name in columns if not load or name not in LOAD_NAMES]
    table = np.array([np.zeros(len(quantities_at_points(view))), *(columns[name] for name in names)])
    return np.unique(table, axis=1, return_inverse=True)[1].ravel()


def _drag_sentences(view, page, start, chosen, numbers):
    """The check of how much drag changes numbers at chosen points, by their name in the sentence."""
    found, alike = [], _alike_but_for_drag(view)
    sentence = rf"{start}the results of an arm vary over the NUMBER drags of its range: (.*)$"
    for line, match in read(page, sentence):
        why = [] if int(match[1]) == len(DRAG_ESTIMATE_NAMES) else ["drags"]
        items = re.findall(
            rf"([a-z ]+?) by (up to )?(?:({NUMBER}) %|a factor of ({NUMBER}))(?:, |$)", match[2]
        )
        why += [] if items and len(items) == match[2].count(" by ") else ["nothing reads it"]
        for name, _, percent, factor in items:
            values = np.where(chosen, numbers[name], np.nan)
            each = [values[(alike == n) & np.isfinite(values)] for n in np.unique(alike)]
            most = max(some.max() / some.min() for some in each if len(some) > 1)
            said, true = (percent, 100 * (most - 1)) if percent else (factor, most)
            off = abs(float(said) - true) > TWO_DIGITS * true
            why += [f"{name} by {most}"] if off else []
        found.append((line, "; ".join(filter(None, why))))
    beats = np.isfinite(numbers.get("frequency", np.array([])))
    of_each = [beats[(alike == n) & chosen] for n in np.unique(alike[chosen])] if beats.size else []
    true = {
        "for every drag": sum(b.all() for b in of_each),
        "for part of the range of drag": sum(b.any() and not b.all() for b in of_each),
        "for no drag": sum(not b.any() for b in of_each),
    }
    for line, match in read(page, rf"{start}of NUMBER combinations? of arm and load: beats (.*)$"):
        told = {
            words: int(n) for words, n in re.findall(rf"([a-z ]+) at ({NUMBER})", match[2].replace(", ", ","))
        }
        right = told == {words: n for words, n in true.items() if n} and int(match[1]) == len(of_each)
        found.append((line, "" if right else f"it is {true}"))
    return found


def _answer(view, page, fine, scales):
    """The check of the line that answers first, of all points or of those where the model applies."""
    inside = (np.asarray(view.variables["model_applies"]) != Validity.does_not_apply).ravel()
    prefix = next(
        (
            p
            for p in ("where the model applies: ", "if the model applied: ")
            if any(x.startswith(p) for x in page)
        ),
        "",
    )
    chosen = inside if prefix.startswith("where") else np.ones_like(inside)
    start, count, found = f"^{re.escape(prefix)}", int(chosen.sum()), []
    some = r"(?: at NUMBER of NUMBER points?)?"
    value, to_hertz = rf"RANGE ({UNIT})", 1 / (2 * pi * scales["tau2"])

    def told(pattern, number, *true):
        for line, match in read(page, start + pattern):
            groups = list(match.groups())
            why = [] if groups[0] is None or int(groups[0]) == number else [f"it is {number}"]
            why += [] if groups[1] is None or int(groups[1]) == count else [f"of {count}"]
            for k, values in enumerate(true):
                text, unit = groups[2 + 2 * k : 4 + 2 * k]
                if text is not None:
                    why.append(range_as_stated(text, np.asarray(values) / UNITS_AND_EXAMPLES[unit]))
            found.append((line, "; ".join(filter(None, why))))

    if view.task in ("thresholds", "criticality", "phase_diagram"):
        found += _flutter_answer(view, page, told, start, chosen, scales)
    elif view.task in ("spectrum", "modes"):
        w = np.array([leading(rod)[0] for rod in rods_of(view)])
        gives_way = chosen & (w.real > 0)
        told(
            rf"the straight arm is unstable{some}; its leading mode oscillates at {value}$",
            gives_way.sum(),
            (w.imag * to_hertz)[gives_way],
        )
        wrong = [x for x in page if x.startswith(f"{prefix}the straight arm is stable") and gives_way.any()]
        found += [(line, "a mode grows") for line in wrong]
    elif view.task == "limit_cycle":
        v = fine.variables
        hertz, y = v["frequency"].ravel() * to_hertz, v["tip_y_max"].ravel() * scales["length"]
        told(
            rf"beats{some} at {value}, its tip by {value} to",
            np.isfinite(hertz[chosen]).sum(),
            hertz[chosen],
            y[chosen],
        )
        codes = {word: code for code, word in view.status_flags.items()}
        for status, words in WITHOUT_CYCLE.items():
            told(
                rf"{re.escape(words)}{some}$",
                (view.variables["status"].ravel()[chosen] == codes.get(status)).sum(),
            )
        power = v["injection_mean"].ravel() * scales["force_scale"] * scales["length"] / scales["tau2"]
        numbers = {"frequency": hertz, "reach of the tip": y, "power": power}
        found += _drag_sentences(view, page, start, chosen, numbers)
    elif view.task == "branch":
        v, rows = view.variables, len(scales["tau2"])
        loads = v["branch_F"].reshape(rows, -1) * scales[force_unit(view)][:, None]
        hertz = 1 / (v["period"].reshape(rows, -1) * scales["tau2"][:, None])
        words = rf"cycles{some}, stable or not, exist at {value}; they beat at {value}$"
        told(words, 0, loads[chosen], hertz[chosen])
    return found


def _flutter_answer(view, page, told, start, chosen, scales):
    """The same of flutter, at chosen rods; told: checks a pattern with a number and true values."""
    some, value = r"(?: at NUMBER of NUMBER points?)?", rf"RANGE ({UNIT})"
    loads, hertz = _first(view, scales, "hopf")
    there = np.isfinite(loads[chosen])
    flutter = rf"flutter begins{some} at {value}; there the arm beats at {value}$"
    told(flutter, there.sum(), loads[chosen], hertz[chosen])
    if view.task != "criticality" or "F_end" in view.variables:
        tops = np.minimum(_tops(view), view.point_columns["k1"])
        ends = (tops * scales[force_unit(view)])[chosen]
        told(rf"does not flutter{some} up to {value}$", (~there).sum(), ends)
    if view.task == "thresholds" and len(chosen) > 1:
        onset, back = (_first(view, scales, kind)[0][chosen] for kind in ("onset", "restabilization"))
        told(rf"decaying disturbances{some} start to oscillate at {value}$", 0, onset)
        told(rf"the straight arm is stable again{some}, from {value} on$", np.isfinite(back).sum(), back)
    in_newton = []
    if view.task == "thresholds" and force_unit(view) == "pressure_scale":
        forces = loads * scales["force_scale"] / scales["pressure_scale"]
        told(rf"flutter{some} as a force at the tip: {value}(?:$|, )", 0, forces[chosen])
        before = rf"{start}flutter as a force at the tip: .*, smallest"
        in_newton = _extremes(view, page, before, forces, chosen)
    if view.task == "phase_diagram":
        in_newton = _compression(view, page, scales)
    numbers = {"flutter": loads, "its frequency": hertz}
    found = in_newton + _drag_sentences(view, page, start, chosen, numbers)
    return found + _extremes(view, page, rf"{start}smallest flutter load", loads, chosen)


def _compression(view, page, scales):
    """The check of the loads above which compression makes the model doubtful on a row, or exceeds its
    limit, a tenth of the weakest section."""
    limits = np.array([0.1 * rod.crushing_force for rod in _rods_without_load(view)])
    verdicts = {
        DOUBTFUL_RATIO: f"is more than ({DOUBTFUL_RATIO}) times its limit, and the model is doubtful",
        1.0: "exceeds its limit, and the model does not apply",
    }
    found = []
    for share, verdict in verdicts.items():
        lines = list(read(page, rf"^above RANGE ({UNIT}) compression {verdict}$"))
        if not share * limits.min() < max(_tops(view)):
            found += [(line, "no load is as large") for line, _ in lines]
            continue
        loads = (share * limits * scales[force_unit(view)])[np.isfinite(limits)]
        told = [
            (line, range_as_stated(match[1], loads / UNITS_AND_EXAMPLES[match[2]])) for line, match in lines
        ]
        found += told or [("", f"it is not said above which load compression {verdict}")]
    return found


def _extremes(view, page, start, loads, chosen):
    """The check of which arms flutter at the least and at the largest of loads."""
    loads, found = np.where(chosen, loads, np.nan), []
    for line, match in read(page, rf"{start} at (.*); largest at (.*)$"):
        ends = (np.nanmin(loads), np.nanmax(loads))
        why = [_of_one(view, text, loads, end) for text, end in zip(match.groups(), ends, strict=True)]
        found.append((line, "; ".join(filter(None, why))))
    return found


def _of_one(view, text, loads, end):
    """Why a text tells no arm that flutters at a load; empty where one of equal ones is it."""
    there = np.flatnonzero(np.abs(loads / end - 1) < EQUAL_LOADS)
    each = [region_as_stated(view, text, np.arange(len(loads)) == i) for i in there]
    return "" if "" in each else each[0]


def _validity_line(view, page, fine):
    """The check of whether the model applies, and of the largest of what it leaves out."""
    excess, applies, rests = [], [], []
    for i, q in enumerate(quantities_at_points(view)):
        arm = arm_of(q)
        rate, F, amplitude, cycles = _motion(view, fine, i)
        rests.append(np.isnan(np.max(rate)) if view.task == "phase_diagram" else None)
        if "drag" in q and view.task != "phase_diagram":
            rate = np.asarray(rate) / scales_of(q)["tau2"]
            effects = neglected_effects(arm, rate, F, drag=arm.chosen_drag, amplitude=amplitude)
        else:
            effects = neglected_effects(
                arm, angular_frequency_at_smallest_drag(arm, rate), F, amplitude=amplitude
            )
        of = [e for e in effects if cycles or not e.is_of_cycles_only]
        applies.append(int(np.max(worst_validity(effects, of_cycles=cycles))))
        excess.append(max(float(np.nanmax(np.append(e.value_over_limit, -1.0))) for e in of))
    found, count = [], len(excess)
    for line, match in read(
        page,
        rf"^the model (does not apply|is doubtful){POINTS}{JUDGED}"
        r": .* is (?:up to )?NUMBER times its limit(?:, more than NUMBER)?"
        r"(?:; not known (?:at|on) NUMBER of NUMBER (?:points|rows))?$",
    ):
        known = np.ravel(view.variables["model_applies"]) >= 0
        worst = max(np.array(applies)[known])
        there = known & (np.array(applies) == worst)
        why = [] if (worst == 2) == (match[1] == "does not apply") and worst else [f"validity is {worst}"]
        largest = np.max(np.array(excess)[there])
        if abs(float(match[6]) - largest) > TWO_DIGITS * largest:
            why.append(f"it is {largest}")
        if (worst == 1) != (match[7] is not None and float(match[7]) == DOUBTFUL_RATIO):
            why.append(f"a model is doubtful above {DOUBTFUL_RATIO}")
        why += _judged(match["judged"], match[5], rests)
        if match[2] and int(match[2]) != there.sum():
            why.append(f"at {there.sum()} points")
        if match[3] and int(match[3]) != count:
            why.append(f"of {count} points")
        found.append((line, "; ".join(why)))
    for line, match in read(page, rf"^the model applies{POINTS}{JUDGED}$"):
        why = [f"{match[0]}: validity is {applies}"] if max(applies) else []
        found.append((line, "; ".join(why + _judged(match["judged"], match[4], rests))))
    for line, _ in read(page, rf"^whether the model applies is not known{POINTS}: "):
        found.append((line, "it is known" if (np.ravel(view.variables["status"]) == 0).any() else ""))
    return found or [(page[0], "nothing is said of whether the model applies")]


def _judged(clause, number, rests):
    """Why the clause on where the rows of a diagram were judged is wrong, in a list. rests: whether each row
    has no Hopf point, None each for other tasks."""
    if rests[0] is None:
        return ["it is no diagram"] if clause else []
    many, still = " of each row" * (len(rests) > 1), sum(rests)
    rest = f", and at rest without load on {number} row{'s' * (still > 1)} without" * (still > 0)
    true = f", judged at the first Hopf point{many}{rest}"
    true = ", judged at rest without load" if still == len(rests) else true
    return [] if clause == true and int(number or 0) in (0, still) else [f"{still} of {len(rests)} rest"]


def _motion(view, fine, i):
    """(frequencies, forces, amplitudes, whether they are of cycles) at a point of a file."""
    columns = view.point_columns
    if view.task in ("thresholds", "criticality", "phase_diagram"):
        top = (
            float(view.variables["F"][-1])
            if view.task == "phase_diagram"
            else float(view.variables["F_end"].ravel()[i])
        )
        rod = rod_of(0.0, *(float(columns[name][i]) for name in ("k1", "k2", "gamma3")))
        hopf = next((c for c in changes_over_force(rod, top) if c.kind.name == "hopf"), None)
        return (
            (hopf.frequency, hopf.value, LARGE_AMPLITUDE, False)
            if hopf
            else (np.nan, np.nan, LARGE_AMPLITUDE, False)
        )
    if view.task == "limit_cycle":
        v = fine.variables
        frequency, y = float(v["frequency"].ravel()[i]), float(v["tip_y_max"].ravel()[i])
        linear_frequency = float(v["linear_frequency"].ravel()[i])
        # An arm that becomes straight moves in its leading mode.
        if int(v["status"].ravel()[i]) == int(CycleStatus.straight) and linear_frequency > 0:
            frequency = linear_frequency
        return frequency, float(columns["F"][i]), y if np.isfinite(y) else 0.0, True
    if view.task == "branch":
        v, rows = view.variables, view.variables["status"].size
        period, F, y = (v[name].reshape(rows, -1)[i] for name in ("period", "branch_F", "tip_y_max"))
        return 2 * pi / period, F, y, True
    modes = np.abs(view.variables["frequency"].reshape(len(columns["F"]), -1)[i])
    moving = modes[modes > 0]
    return moving[0] if len(moving) else np.nan, float(columns["F"][i]), LARGE_AMPLITUDE, False


# --- the report of `rodsweep arm` ---


def random_report(index):
    """Quantities of a random arm with a load in most cases, at times relative to flutter or a pull."""
    random = np.random.default_rng([32, index])
    arm = random_arm(random, load=random.random() < 0.8)
    if "pressure" in arm and random.random() < 0.2:
        arm["pressure"] = f"{random.uniform(0.5, 2):.2f} of flutter"
    return arm


def wrong_report(given):
    """(sentences of the report on an arm with a wrong number or one that nothing reads; numbers read)."""
    try:
        arm = rs.Arm(**given)
        report = arm.report()
    except rs.InputError as refused:  # "1.2 of flutter" of an arm that does not flutter
        return ([] if "of flutter" in given.get("pressure", "") else [(str(refused), "refused")]), 0
    rows = [f"row {row.name}: {row.value}" for row in report.rows]
    checks = [check.text for check in (*report.warnings, *report.checks)]
    page = Page("\n".join(["", *report.verdict, *rows, *checks]))
    truth = ArmTruth(arm, report)
    found = truth.verdict(page) + truth.rows(page) + truth.checks(page)
    wrong = [(line, why) for line, why in found if why]
    wrong += [(line, f"nothing reads {', '.join(numbers)}") for line, numbers in page.unread()]
    return wrong, sum(map(len, page.seen.values()))


class ArmTruth:
    """True numbers of an arm in the plane in which it flutters first."""

    def __init__(self, arm, report):
        self.report = report
        planes = [_si(arm)]
        if "height" in planes[0] and planes[0]["height"] != planes[0]["width"]:
            planes.append(planes[0] | {"width": planes[0]["height"], "height": planes[0]["width"]})
        each = [self._flutter(q) for q in planes]
        first = min(range(len(each)), key=lambda n: each[n]["first_force"])
        self.q, self.own = planes[first], each[first]
        self.other = each[1 - first] if len(each) > 1 else None
        self.name = "" if not self.other else f" in the plane of its {('height', 'width')[first]}"
        load = next((name for name in LOAD_NAMES if getattr(arm, name) is not None), None)
        self.load_name, self.share = load or "pressure", arm.load_over_flutter if load else None
        unit = scales_of(self.q)["force_scale" if load == "force" else "pressure_scale"]
        self.unit = unit
        if load is None:
            self.F = None
        elif self.share is not None:
            self.F = self.share * self.own["hopf"][0]
        else:
            self.F = getattr(arm.si, load) / unit

    @staticmethod
    def _flutter(q):
        """Changes of an arm with every drag: F of the first of each kind, frequency in Hz."""
        A, moment, *_ = section_of(q)
        k3, length = q["young"] * moment, q["length"]
        k1 = q["young"] * A * length**2 / k3
        k2 = _kappa(q) * q["young"] / (2 * (1 + q["poisson"])) * A * length**2 / k3
        found = {"hopf": [], "onset": [], "restabilization": [], "hertz": [], "crossings": [], "gamma3": []}
        for _, gamma2, gamma3 in drags_of(q):
            ratio = gamma3 / (gamma2 * length**2)
            crossings = changes_over_force(Rod(F=0.0, k1=k1, k2=k2, gamma3=ratio), 1000.0)
            for kind in ("hopf", "onset", "restabilization"):
                first = next((c for c in crossings if c.kind.name == kind), None)
                found[kind].append(first.value if first else np.nan)
                if kind == "hopf":
                    tau2 = gamma2 * length**4 / k3
                    found["hertz"].append(abs(first.frequency) / (2 * pi * tau2) if first else np.nan)
            found["crossings"].append(crossings)
            found["gamma3"].append(ratio)
        hopf = found["hopf"][0]
        first_force = inf if np.isnan(hopf) else hopf * k3 / length**2
        return found | {"k1": k1, "k2": k2, "k3": k3, "first_force": first_force, "end": min(1000.0, k1)}

    def _loads(self, forces, unit=None):
        return np.asarray(forces) * (self.unit if unit is None else unit)

    def verdict(self, page):
        """The check of the verdict: where flutter is, on which side of it the load is, how fast it beats."""
        own, found = self.own, []
        hopf = np.asarray(own["hopf"])

        def told(pattern, *true):
            for line, match in read(page, pattern):
                pairs = zip(match.groups()[::2], match.groups()[1::2], strict=True)
                why = [
                    range_as_stated(text, np.asarray(values) / UNITS_AND_EXAMPLES[unit])
                    for (text, unit), values in zip(pairs, true, strict=True)
                ]
                found.append((line, "; ".join(filter(None, why))))

        value, name = rf"RANGE ({UNIT})", re.escape(self.name)
        loads = self._loads(hopf)
        told(rf"^The arm flutters at {value}{name}: above", loads)
        told(rf"flutter, at {value}{name}: the", loads)
        told(rf"lies in the range of flutter, {value}{name}: drag", loads)
        told(rf"^Flutter is at {value}{name};", loads)
        told(rf"^Flutter, at {value}{name}, is within", loads)
        told(rf"would flutter at {value}{name}(?:\.| and)", loads)
        told(rf"begins? to beat at {value}", own["hertz"])
        told(rf"straight arm is stable again above {value}", self._loads(own["restabilization"]))
        told(rf"^From {value} on.*, a disturbed arm", self._loads(own["onset"]))
        told(rf"(?:crushed at|up to) {value}", [self._loads(own["end"])])
        if self.other:
            unit = self._other_unit()
            told(
                rf"^In the plane of its \w+ flutter (?:is|would be) at {value}",
                self._loads(self.other["hopf"], unit),
            )
            told(
                rf"^In the plane of its \w+ there \w+ ?\w* no flutter "
                rf"(?:before it is crushed at|up to) {value}",
                [self.other["end"] * unit],
            )
        for line in page:
            if self.F is not None:
                found.append((line, self._side(page, line, hopf)))
        return found + self._remedies(page)

    def _other_unit(self):
        turned = self.q | {"width": self.q["height"], "height": self.q["width"]}
        return scales_of(turned)["force_scale" if self.load_name == "force" else "pressure_scale"]

    def _side(self, page, line, hopf):
        """Why a load is not on the side of flutter, or not as far from it, as the verdict says."""
        F, low, high = self.F, np.nanmin(hopf, initial=inf), np.nanmax(hopf, initial=-inf)
        for _, match in read(
            page, r"(?:is|would be) RANGE( %|) (below|above|times|) ?(?:flutter|that threshold)", only=line
        ):
            text, _, word = match.groups()
            if word not in ("below", "above"):
                true = np.array([F / high, F / low])
            else:
                true = 100 * (np.array([F / high, F / low]) - 1) * (1 if word == "above" else -1)
            if (true < 0).any() or (word == "below") != (low > F):
                return f"F = {F}, flutter {low} to {high}"
            return range_as_stated(text, true)
        if (
            "lies in the range" in line
            and not low <= F <= high
            and len({self._grows(n) for n in range(5)}) == 1
        ):
            return f"F = {F} is outside of {low} to {high}"
        if ": the arm beats" in line and not all(self._grows(n) for n in range(5)):
            return "with some drag the arm is stable"
        if "straight arm is stable again." in line and any(self._grows(n) for n in range(5)):
            return "with some drag the arm is unstable"
        return ""

    def _grows(self, n):
        """Whether the straight arm is unstable with the n-th drag."""
        return (
            leading(Rod(F=self.F, k1=self.own["k1"], k2=self.own["k2"], gamma3=self.own["gamma3"][n]))[0].real
            > 0
        )

    def _remedies(self, page):
        """By how much effects are too large, and what would have to change: tried."""
        found = []
        effects = self._effects()
        for line, match in read(page, r"(?:: |^)([A-Za-z ]+) is NUMBER times what the model allows"):
            name = match[1].strip().lower()
            excess = max((float(e.value_over_limit) for e in effects if e.name == name), default=np.nan)
            off = abs(float(match[2]) - excess) > TWO_DIGITS * excess
            found.append((line, f"{name} is {excess}" if off else ""))
        for line, match in read(page, rf"at least NUMBER times as viscous \(NUMBER ({UNIT})\)"):
            true = float(match[2]) * UNITS_AND_EXAMPLES[match[3]] / self.q["viscosity"]
            why = "" if abs(true / float(match[1]) - 1) < 2 * TWO_DIGITS else f"it is {true} times"
            found.append((line, why or self._no_remedy(match[1], -1, "viscosity")))
        for line, match in read(page, r"at most NUMBER times as thick"):
            found.append((line, self._no_remedy(match[1], 2, *(side for side in SIDES if side in self.q))))
        for line, match in read(page, rf"a (?:load|pull) of at most NUMBER ({UNIT})(?=[.;])"):
            F = float(match[1]) * UNITS_AND_EXAMPLES[match[2]] / self.unit
            excess = abs(F) / self.own["k1"] / 0.1
            found.append((line, "" if 0.98 < excess <= 1 else f"it is {excess} times the limit"))
        for line, match in read(page, r"within NUMBER (\S+) of the fluid's"):
            q = self.q | {"density_difference": float(match[1]) * UNITS_AND_EXAMPLES.get(match[2], 1.0)}
            weight = next(
                float(e.value_over_limit)
                for e in neglected_effects(SlenderArm(**q), np.nan, np.nan)
                if e.name == "weight"
            )
            found.append((line, "" if 0.85 < weight <= 1 + 1e-9 else f"it is {weight} times the limit"))
        for line, match in read(page, rf"^NUMBER ({UNIT}) is NUMBER of flutter with the likeliest drag"):
            true = float(match[3]) * self.own["hopf"][0] * self.unit / UNITS_AND_EXAMPLES[match[2]]
            found.append((line, as_stated(match[1], true)))
        load = re.compile(
            rf"({NUMBER}) ({UNIT}) (?:is|lies|would|does)\b|(?:at|straight at) ({NUMBER}) ({UNIT})(?=[:.])"
            rf"|; ({NUMBER}) ({UNIT}) (?:is|does) not"
        )
        for line in page:
            for match in load.finditer(line) if self.F is not None else ():
                text, unit = [group for group in match.groups() if group][:2]
                k = next(i for i, group in enumerate(match.groups(), 1) if group)
                if not any(a <= match.start(k) < b for a, b in page.seen[line]):
                    page.mark(line, match.span(k))
                    found.append((line, as_stated(text, self.F * self.unit / UNITS_AND_EXAMPLES[unit])))
        return found

    def _no_remedy(self, factor, towards, *names):
        """Why a factor does not bring inertia within its limit, or `towards` digits less would, too."""
        digit = 10.0 ** (floor(log10(float(factor))) - 1)
        within = [
            self._inertia(self.q | {name: by * self.q[name] for name in names})
            for by in (float(factor), float(factor) + towards * digit)
        ]
        return (
            ""
            if within[0] <= 1.001 and within[1] > 1
            else f"inertia is then {within[0]} times its limit, {within[1]}"
        )

    def _inertia(self, q):
        """Largest effect of inertia at flutter, in units of its limit."""
        flutter = self._flutter(q)
        arm = SlenderArm(**q)
        rate = 2 * pi * flutter["hertz"][0] * drags_of(q)[0][1] / min(d[1] for d in drags_of(q))
        return max(
            float(e.value_over_limit)
            for e in neglected_effects(arm, rate, flutter["hopf"][0])
            if "inertia" in e.name
        )

    def _effects(self):
        arm = SlenderArm(**self.q)
        hopf, hertz = self.own["hopf"], self.own["hertz"]
        n = next((i for i, F in enumerate(hopf) if np.isfinite(F)), 0)
        drags = drags_of(self.q)
        rate = 2 * pi * hertz[n] * drags[n][1] / min(d[1] for d in drags)
        effects = list(neglected_effects(arm, rate, hopf[n]))
        if self.F is not None:
            effects += [e for e in neglected_effects(arm, np.nan, self.F) if e.name == "compression"]
        return effects

    def rows(self, page):
        """The check of the table of numbers."""
        q, own, drags = self.q, self.own, drags_of(self.q)
        A, moment, face, *_ = section_of(q)
        length, k3 = q["length"], own["k3"]
        over = {
            "drag across": [d[1] for d in drags],
            "axial drag": [d[0] for d in drags],
            "rotational drag": [d[2] for d in drags],
            "tau2": [d[1] * length**4 / k3 for d in drags],
            "flutter force": [F * k3 / length**2 for F in own["hopf"]],
            "gamma3": own["gamma3"],
            "gamma1": [d[0] / d[1] for d in drags],
        }
        numbers = {"A": A, "I": moment, "kappa": _kappa(q), "k3": k3, "k3/L^2": k3 / length**2}
        numbers |= {"k1": own["k1"], "k2": own["k2"]}
        if self.F is not None:
            numbers |= {"F": self.F, "tip force": self.F * k3 / length**2}
        found = []
        for name, true in numbers.items():
            for line, match in read(page, rf"^row {re.escape(name)}: NUMBER"):
                found.append((line, as_stated(match[1], true)))
        for name, true in over.items():
            for line, match in read(page, rf"^row {name}: NUMBER \(RANGE\)"):
                why = (as_stated(match[1], true[0]), range_as_stated(match[2], true))
                found.append((line, "; ".join(filter(None, why))))
        return found

    def checks(self, page):
        """The check of what the model leaves out."""
        found, effects = [], {}
        for effect in self._effects():
            effects.setdefault(effect.name, float(effect.value))
        for line, match in read(page, r"the arm is NUMBER radii long(?:; below NUMBER local)?"):
            found.append((line, as_stated(match[1], self.q["length"] / section_of(self.q)[3])))
        compression = [effects["compression"]] if np.isfinite(effects["compression"]) else []
        compression += [abs(self.F) / self.own["k1"]] if self.F is not None else []
        for line, match in read(page, r"the load \w+ the arm by NUMBER %"):
            found.append((line, _two(match[1], 100 * abs(self.F) / self.own["k1"])))
        for line, match in read(page, r"the flutter load shortens (?:it|the arm) by NUMBER %"):
            found.append((line, _two(match[1], 100 * effects["compression"])))
        for line, match in read(page, r"rubber is some NUMBER % stiffer"):
            c = max(compression)
            found.append((line, _two(match[1], 100 * 2 * ((1 - c) ** -3 - 1) / 3, 0.6)))
        for line, match in read(page, r"over drag is NUMBER for the arm and NUMBER for the fluid beside it"):
            pair = zip(match.groups(), ("arm", "fluid"), strict=True)
            found.append(
                (line, "; ".join(filter(None, (_two(t, effects[f"inertia of the {n}"]) for t, n in pair))))
            )
        for line, match in read(page, r"lower the threshold of flutter by some NUMBER %"):
            both = effects["inertia of the arm"] + effects["inertia of the fluid"]
            found.append((line, _two(match[1], 64 * both, 0.6)))
        found += [
            (line, "" if match[1] == "0.1" else "the limit is 0.1")
            for line, match in read(page, r"and applies only up to NUMBER\.?$")
        ]
        for line, match in read(page, r"Reynolds number: NUMBER if"):
            found.append((line, _two(match[1], effects["Reynolds number"])))
        for line, match in read(page, r"Wall: .* which (?:takes some NUMBER % of its|(folds) the tube)"):
            lost = lost_by_flattening(self.q)
            why = _two(match[1], 100 * lost) if match[1] else "" if lost >= 1 else f"it loses {lost}"
            found.append((line, why))
        for line, match in read(page, r"buoyancy is NUMBER of the weight that buckles"):
            found.append((line, _two(match[1], effects["weight"])))
        for line, match in read(page, r"sags by NUMBER of its length"):
            found.append((line, _two(match[1], 7.837 / 8 * effects["weight"])))
        for line, match in read(page, r"Poisson's ratio: NUMBER,(?:.*near NUMBER;)?"):
            found.append((line, as_stated(match[1], self.q["poisson"])))
        return found


def lost_by_flattening(q):
    """Fraction of its bending stiffness that a tube loses at the curvature of beating with large amplitude.

    The ring's radial displacement r z cos 2 theta, without extension, minimises the energies of bending the
    tube and the wall; the second moment is that of the displaced ring to first order in z.
    """
    outer, inner = q["radius"], q["inner_radius"]
    r, t = (outer + inner) / 2, outer - inner
    theta = 2 * pi * (np.arange(64) + 0.5) / 64
    y, dy = np.sin(theta), np.cos(2 * theta) * np.sin(theta) - np.sin(2 * theta) * np.cos(theta) / 2
    moment, slope = 2 * pi * r**3 * t * np.mean(y**2), 2 * pi * r**3 * t * np.mean(2 * y * dy)
    wall = 2 * pi / r * t**3 / (12 * (1 - q["poisson"] ** 2)) * np.mean((3 * np.cos(2 * theta)) ** 2)
    curvature = CURVATURE_OVER_AMPLITUDE * LARGE_AMPLITUDE / q["length"]
    z = -(curvature**2) * slope / (2 * wall)
    return -slope * z / moment


def _two(text, true, slack=TWO_DIGITS):
    """Why a number of one or two digits is not the true one."""
    return "" if abs(float(text) - true) <= slack * abs(true) + 1e-300 else f"{text} is {true}"


def _si(arm):
    """The quantities of an arm as numbers in SI, without its load."""
    names = ("length", "young", "viscosity", "fluid_density", "density_difference", *SIDES)
    given = {name: float(getattr(arm.si, name)) for name in names if getattr(arm, name) is not None}
    return given | {"poisson": arm.poisson}


def _kappa(q):
    """Cowper's shear coefficient."""
    nu = q["poisson"]
    if "width" in q:
        return 10 * (1 + nu) / (12 + 11 * nu)
    m = (q.get("inner_radius", 0.0) / q["radius"]) ** 2
    return 6 * (1 + nu) * (1 + m) ** 2 / ((7 + 6 * nu) * (1 + m) ** 2 + (20 + 12 * nu) * m)
