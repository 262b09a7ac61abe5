"""What is said of arms in SI units, on the page of `show` and in the report of `rodsweep arm`.

Scales are computed here anew from the quantities of the arm: section, drag of a slender cylinder (Cox 1970,
Gray and Hancock 1955, Lighthill 1976), k3/L^2 and tau2. Thresholds are those of the covering for every drag.
"""

import re
from math import floor, inf, log, log10, pi

import numpy as np

import rodsweep as rs
from rodsweep.model.arm import SlenderArm
from rodsweep.model.neglected import HALF_LENGTH, Validity, effects_of, fastest_rate, worst_validity
from rodsweep.model.rod import Rod
from rodsweep.post.hopf_points import lines_over

from .page import NUMBER, Page, as_stated, range_as_stated, read
from .truths import changes_along, changes_over_force, leading, rods_of

PREFIXES = {"p": 1e-12, "n": 1e-9, "µ": 1e-6, "m": 1e-3, "c": 1e-2, "": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}
BASES = ("Pa s", "Pa", "N m^2", "N", "Hz", "1/s", "s", "m^2", "m^4", "m", "J", "W", "kg/m^3")
UNITS = {f"{p}{base}": factor for base in BASES for p, factor in PREFIXES.items()} | {"P": 0.1, "1/s": 1.0}
UNITS |= {"m^2": 1.0, "mm": 1e-3, "g/cm^3": 1e3}
UNIT = "|".join(sorted(map(re.escape, UNITS), key=len, reverse=True))
SIDES = ("radius", "inner_radius", "width", "height")
LOADS = ("pressure", "force")
KINDS = {"F** (straight": "hopf", "restabilization (straight": "restabilization", "F* (straight": "onset"}
TWO_DIGITS = 0.06
"""Relative difference that two digits leave."""


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
    tau2 = drags_of(q)[0][1] * q["length"] ** 4 / (q["young"] * moment)
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


def in_si(view):
    """Units of the arm at every point, by name, each (points,)."""
    each = [scales_of(q) for q in quantities_at_points(view)]
    return {name: np.array([scales[name] for scales in each]) for name in each[0]}


def force_unit(view):
    return "force_scale" if "force" in view.quantities else "pressure_scale"


# --- the page of a sweep ---


def arm_sentences(view, page, fine):
    """The check of every line in SI units of a sweep of an arm."""
    scales = in_si(view)
    found = _quantity_lines(view, page) + _validity_line(view, page, fine)
    for i, line in enumerate(page):
        if line.startswith("in SI units: "):
            found += [_item(view, page, line, match, fine, scales) for match in _items(line)]
        elif line.startswith("  in SI units: "):
            found.append((line, _threshold_in_si(view, page, line, page[i - 1], scales)))
    return found + _answer(view, page, fine, scales)


def _quantity_lines(view, page):
    """The table of quantities in the units in which they were typed."""
    found = []
    for name, values in view.quantities.items():
        for line, match in read(page, rf"^{name} +NUMBER +NUMBER +NUMBER +(\S.*)$"):
            true = np.unique(np.asarray(values, float)) / UNITS.get(match[4], 1.0)
            why = [as_stated(match[2], true.min()), as_stated(match[3], true.max())]
            why += [] if int(match[1]) == len({f"{x:.9g}" for x in true}) else [f"{len(true)} values"]
            found.append((line, "; ".join(filter(None, why))))
    return found


def _items(line):
    return re.finditer(rf"(\w+) = ({NUMBER}(?:(?:, | to ){NUMBER})*) ({UNIT})(?=;|$)", line)


def _item(view, page, line, match, fine, scales):
    """An item of what is said in SI units of a whole file, such as "period = 1 to 2 s"."""
    page.mark(line, match.span(2))
    name, text, unit = match.groups()
    base = UNITS[unit]
    event = re.fullmatch(r"frequency_(hopf|restabilization)", name)
    name = (
        f"{event[1]}_frequency"
        if event
        else "_".join("F" if word in LOADS else word for word in name.split("_"))
    )
    stored_there = name in view.variables and view.task == "branch" and not name.startswith("special")
    values = np.asarray((view if stored_there else fine).variables[name], float)  # its cycles are elsewhere
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


def _threshold_in_si(view, page, line, before, scales):
    """Why thresholds in SI units are not those of the line before."""
    kind = next((kind for start, kind in KINDS.items() if before.startswith(start)), None)
    to_load, to_hertz = scales[force_unit(view)], 1 / (2 * pi * scales["tau2"])
    if kind:
        pairs = []
        for path in lines_over(view, "F"):
            rod = Rod(float(path.x.min()), *(path.parameters[n] for n in ("k1", "k2", "gamma3")))
            low = 0.0 if view.task == "limit_cycle" else float(path.x.min())
            for c in changes_along(rod, "F", low, float(path.x.max())):
                after = {"hopf": 2, "restabilization": 0}.get(kind, c.unstable_after)
                if c.kind.name == kind and c.unstable_after == after:
                    pairs += [(c.at * to_load[i], c.frequency * to_hertz[i]) for i in path.at]
    elif match := re.match(rf"(\w+) at F = ({NUMBER})", before):
        rod = Rod(0.0, *(float(view.point_columns[n][0]) for n in ("k1", "k2", "gamma3")))
        at = min(changes_over_force(rod, 2 * float(match[2])), key=lambda c: abs(c.at - float(match[2])))
        pairs = [(at.at * to_load[0], at.frequency * to_hertz[0])]
    elif match := re.match(r"(\w+): on", before):
        pairs, top = [], float(view.variables["F"][-1])
        for i in range(len(to_load)):
            rod = Rod(0.0, *(float(view.point_columns[n][i]) for n in ("k1", "k2", "gamma3")))
            pairs += [
                (c.at * to_load[i], nan_)
                for c in changes_over_force(rod, top)
                if c.kind.name == match[1]
                for nan_ in [0.0]
            ]
    else:
        return "it follows no threshold"
    loads, frequencies = np.array(pairs).T
    why = []
    for _, match in read(page, rf"in SI units: RANGE ({UNIT})(?:, frequency RANGE ({UNIT}))?$", only=line):
        why.append(range_as_stated(match[1], loads / UNITS[match[2]]))
        if match[3]:
            why.append(range_as_stated(match[3], frequencies / UNITS[match[4]]))
    return "; ".join(filter(None, why)) if why else "nothing reads it"


def _first_flutter(view, scales):
    """(load, frequency in Hz) of the first Hopf point of every rod of a file, nan without."""
    found = []
    columns = view.point_columns
    line = view.variables["F"] if view.task == "phase_diagram" and "F" in view.variables else None
    tops = view.variables["F_end"].ravel() if line is None else np.full(len(columns["k1"]), line[-1])
    for i, top in enumerate(tops):
        rod = Rod(0.0, *(float(columns[name][i]) for name in ("k1", "k2", "gamma3")))
        hopf = next((c for c in changes_over_force(rod, float(top)) if c.kind.name == "hopf"), None)
        nothing = (np.nan, np.nan)
        to_hertz = 1 / (2 * pi * scales["tau2"][i])
        found.append((hopf.at * scales[force_unit(view)][i], hopf.frequency * to_hertz) if hopf else nothing)
    return np.array(found).T


def _answer(view, page, fine, scales):
    """The check of the line that answers first, of all points or of those where the model applies."""
    inside = (np.asarray(view.variables["model_applies"]) != Validity.does_not_apply).ravel()
    prefix = next(
        (p for p in ("where it applies: ", "if it applied: ") if any(x.startswith(p) for x in page)), ""
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
                    why.append(range_as_stated(text, np.asarray(values) / UNITS[unit]))
            found.append((line, "; ".join(filter(None, why))))

    if view.task in ("thresholds", "criticality", "phase_diagram"):
        loads, hertz = (values[chosen] for values in _first_flutter(view, scales))
        there = np.isfinite(loads)
        told(rf"flutters{some} from {value}; beats at {value}$", there.sum(), loads, hertz)
        if "F_end" in view.variables:
            ends = (view.variables["F_end"].ravel() * scales[force_unit(view)])[chosen]
            told(rf"does not flutter{some} up to {value}$", (~there).sum(), ends)
    elif view.task in ("spectrum", "modes"):
        w = np.array([leading(rod)[0] for rod in rods_of(view)])
        gives_way = chosen & (w.real > 0)
        told(
            rf"gives way{some}; its leading mode oscillates at {value}$",
            gives_way.sum(),
            (w.imag * to_hertz)[gives_way],
        )
        wrong = [x for x in page if x.startswith(f"{prefix}stays straight") and gives_way.any()]
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
    elif view.task == "branch":
        v, rows = view.variables, len(scales["tau2"])
        loads = v["branch_F"].reshape(rows, -1) * scales[force_unit(view)][:, None]
        hertz = 1 / (v["period"].reshape(rows, -1) * scales["tau2"][:, None])
        told(rf"(?:at NUMBER of NUMBER )?beats at {value}, at {value}$", 0, loads[chosen], hertz[chosen])
    return found


def _validity_line(view, page, fine):
    """The check of whether the model applies, and of the largest of what it leaves out."""
    excess, applies = [], []
    for i, q in enumerate(quantities_at_points(view)):
        arm = SlenderArm(**{name: value for name, value in q.items() if not np.isnan(value)})
        rate, F, amplitude, cycles = _motion(view, fine, i, arm)
        effects = effects_of(arm, fastest_rate(arm, rate), F, amplitude=amplitude)
        of = [e for e in effects if cycles or not e.of_cycles_only]
        applies.append(int(np.max(worst_validity(effects, of_cycles=cycles))))
        excess.append(max(float(np.nanmax(np.append(e.excess, -1.0))) for e in of))
    found, count = [], len(excess)
    for line, match in read(
        page,
        r"^the model (does not apply|is doubtful)(?: at (?:all )?NUMBER (?:of NUMBER )?points?)?"
        r": .* is (?:up to )?NUMBER times its limit$",
    ):
        worst = max(applies)
        there = np.array(applies) == worst
        why = [] if (worst == 2) == (match[1] == "does not apply") and worst else [f"validity is {worst}"]
        largest = np.max(np.array(excess)[there])
        if abs(float(match[4]) - largest) > TWO_DIGITS * largest:
            why.append(f"it is {largest}")
        if match[2] and int(match[2]) != there.sum():
            why.append(f"at {there.sum()} points")
        if match[3] and int(match[3]) != count:
            why.append(f"of {count} points")
        found.append((line, "; ".join(why)))
    for line, match in read(page, r"^the model applies(?: at all points)?$"):
        found.append((line, f"{match[0]}: validity is {applies}" if max(applies) else ""))
    return found or [(page[0], "nothing is said of whether the model applies")]


def _motion(view, fine, i, arm):
    """(frequencies, forces, amplitudes, whether they are of cycles) at a point of a file."""
    columns = view.point_columns
    if view.task in ("thresholds", "criticality", "phase_diagram"):
        top = (
            float(view.variables["F"][-1])
            if view.task == "phase_diagram"
            else float(view.variables["F_end"].ravel()[i])
        )
        rod = Rod(0.0, *(float(columns[name][i]) for name in ("k1", "k2", "gamma3")))
        hopf = next((c for c in changes_over_force(rod, top) if c.kind.name == "hopf"), None)
        return (hopf.frequency, hopf.at, HALF_LENGTH, False) if hopf else (np.nan, np.nan, HALF_LENGTH, False)
    if view.task == "limit_cycle":
        v = fine.variables
        frequency, y = float(v["frequency"].ravel()[i]), float(v["tip_y_max"].ravel()[i])
        return frequency, float(columns["F"][i]), y if np.isfinite(y) else 0.0, True
    if view.task == "branch":
        v, rows = view.variables, view.variables["status"].size
        period, F, y = (v[name].reshape(rows, -1)[i] for name in ("period", "branch_F", "tip_y_max"))
        return 2 * pi / period, F, y, True
    modes = np.abs(view.variables["frequency"].reshape(len(columns["F"]), -1)[i])
    moving = modes[modes > 0]
    assert arm is not None
    return moving[0] if len(moving) else np.nan, float(columns["F"][i]), HALF_LENGTH, False


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
    checks = [check.told for check in (*report.warnings, *report.checks)]
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
        load = next((name for name in LOADS if getattr(arm, name) is not None), None)
        self.load_name, self.share = load or "pressure", arm.share_of_flutter if load else None
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
            crossings = changes_over_force(Rod(0.0, k1, k2, ratio), 1000.0)
            for kind in ("hopf", "onset", "restabilization"):
                first = next((c for c in crossings if c.kind.name == kind), None)
                found[kind].append(first.at if first else np.nan)
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
                    range_as_stated(text, np.asarray(values) / UNITS[unit])
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
        told(rf"would flutter at {value}{name}[,.]", loads)
        told(rf"begins? to beat at {value}", own["hertz"])
        told(rf"straight arm returns at {value}", self._loads(own["restabilization"]))
        told(rf"^From {value} on a disturbance", self._loads(own["onset"]))
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
        if "has returned" in line and any(self._grows(n) for n in range(5)):
            return "with some drag the arm is unstable"
        return ""

    def _grows(self, n):
        """Whether the straight arm is unstable with the n-th drag."""
        return leading(Rod(self.F, self.own["k1"], self.own["k2"], self.own["gamma3"][n]))[0].real > 0

    def _remedies(self, page):
        """By how much effects are too large, and what would have to change: tried."""
        found = []
        effects = self._effects()
        for line, match in read(page, r"(?:: |^)([A-Za-z ]+) is NUMBER times what the model allows"):
            name = match[1].strip().lower()
            excess = max((float(e.excess) for e in effects if e.name == name), default=np.nan)
            off = abs(float(match[2]) - excess) > TWO_DIGITS * excess
            found.append((line, f"{name} is {excess}" if off else ""))
        for line, match in read(page, rf"at least NUMBER times as viscous \(NUMBER ({UNIT})\)"):
            true = float(match[2]) * UNITS[match[3]] / self.q["viscosity"]
            why = "" if abs(true / float(match[1]) - 1) < 2 * TWO_DIGITS else f"it is {true} times"
            found.append((line, why or self._no_remedy(match[1], -1, "viscosity")))
        for line, match in read(page, r"at most NUMBER times as thick"):
            found.append((line, self._no_remedy(match[1], 2, *(side for side in SIDES if side in self.q))))
        for line, match in read(page, rf"a (?:load|pull) of at most NUMBER ({UNIT})(?=[.;])"):
            F = float(match[1]) * UNITS[match[2]] / self.unit
            excess = abs(F) / self.own["k1"] / 0.1
            found.append((line, "" if 0.98 < excess <= 1 else f"it is {excess} times the limit"))
        for line, match in read(page, r"within NUMBER (\S+) of the fluid's"):
            q = self.q | {"density_difference": float(match[1]) * UNITS.get(match[2], 1.0)}
            weight = next(
                float(e.excess) for e in effects_of(SlenderArm(**q), np.nan, np.nan) if e.name == "weight"
            )
            found.append((line, "" if 0.85 < weight <= 1 + 1e-9 else f"it is {weight} times the limit"))
        for line, match in read(page, rf"^NUMBER ({UNIT}) is NUMBER of flutter with the likeliest drag"):
            true = float(match[3]) * self.own["hopf"][0] * self.unit / UNITS[match[2]]
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
                    found.append((line, as_stated(text, self.F * self.unit / UNITS[unit])))
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
        return max(float(e.excess) for e in effects_of(arm, rate, flutter["hopf"][0]) if "inertia" in e.name)

    def _effects(self):
        arm = SlenderArm(**self.q)
        hopf, hertz = self.own["hopf"], self.own["hertz"]
        n = next((i for i, F in enumerate(hopf) if np.isfinite(F)), 0)
        drags = drags_of(self.q)
        rate = 2 * pi * hertz[n] * drags[n][1] / min(d[1] for d in drags)
        effects = list(effects_of(arm, rate, hopf[n]))
        if self.F is not None:
            effects += [e for e in effects_of(arm, np.nan, self.F) if e.name == "compression"]
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
        for line, match in read(page, r"(?:that of flutter|flutter shortens the arm) by NUMBER %"):
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
            for line, match in read(page, r"and allows NUMBER\.?$")
        ]
        for line, match in read(page, r"Reynolds number: NUMBER if"):
            found.append((line, _two(match[1], effects["Reynolds number"])))
        for line, match in read(page, r"buoyancy is NUMBER of what buckles"):
            found.append((line, _two(match[1], effects["weight"])))
        for line, match in read(page, r"sags by NUMBER of its length"):
            found.append((line, _two(match[1], 7.837 / 8 * effects["weight"])))
        for line, match in read(page, r"Poisson's ratio: NUMBER,(?:.*near NUMBER;)?"):
            found.append((line, as_stated(match[1], self.q["poisson"])))
        return found


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
