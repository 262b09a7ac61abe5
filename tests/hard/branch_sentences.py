"""What `show` says of branches, against branches followed far more accurately, and against other solvers.

Hopf points are held against the covering, stable cycles against motions solved in time from the middle of
every range that is called stable, and straight rods that are called stable against their eigenvalues.
"""

import re

import numpy as np
from rods import rod_of

import rodsweep as rs
from rodsweep.post.branch_curves import RodBranches, followed_range
from rodsweep.post.range_unions import intersection_of_ranges, union_of_ranges

from .page import NUMBER, as_stated, counts, range_as_stated, ranges, read, with_error
from .truths import leading

KINDS = {
    "fold": "fold",
    "torus": "torus",
    "symmetry breaking": "symmetry_breaking",
    "period doubling": "period_doubling",
}
PLURALS = {
    "folds?": "fold",
    "torus points?": "torus",
    "symmetry breakings?": "symmetry_breaking",
    "period doublings?": "period_doubling",
}
LEADS_TO = {
    "a cycle that crushes a section of the rod": "left_the_model",
    "the end of the range": "range_end",
    "a force that almost crushes the rod": "crushed",
    "a cycle beyond which the branch was not followed": "no_cycle_found",
}
FARTHEST = 1.5 * (1 + 1e-12)
"""Largest ratio of the force up to which branches are followed to the end of the range."""
CURVED = 2e-3
"""Relative error of a spline through the cycles of a finer branch, which stands for cycles between them."""
DECIDED = 0.02
"""Least relative width of a range in whose middle a motion is solved: near an end it takes too long."""


def branch_sentences(view, page, keywords, fine):
    rods = range(view.variables["status"].size)
    true = {rod: RodBranches(fine, rod).curves for rod in rods}
    own = {rod: RodBranches(view, rod).curves for rod in rods}
    kinds = [
        {
            rod: [[(s.kind, s.reason) for s in curve.special_points] for curve in each]
            for rod, each in some.items()
        }
        for some in (own, true)
    ]
    if kinds[0] != kinds[1]:
        return [(page[0], f"special points {kinds[0]} are {kinds[1]}")]
    found = []
    if len(rods) == 1:
        found += _one_rod(view, page, fine, own[0], true[0])
    else:
        found += _grid(view, page, fine, own, true)
    found += ranges(
        page,
        "^followed in F from RANGE to RANGE(?:, where the force does not crush the rod)?;",
        [keywords.get("start", 0.0)],
        [keywords["stop"]],
    )
    found += followed_beyond(view, page, "followed_", [keywords.get("start", 0.0), keywords["stop"]])
    proved = (view.variables["certified"].sum(), len(rods))
    return found + counts(page, r"list of Hopf points is proved complete for NUMBER of NUMBER rod", *proved)


def followed_beyond(view, page, prefix, ends):
    """How far branches are followed beyond the range `ends` of F: at most to its limits, and as stored."""
    low, high = (view.variables[f"{prefix}{end}"].ravel() for end in ("from", "to"))
    low, high = low[np.isfinite(low)], high[np.isfinite(high)]
    crushing = view.point_columns["k1"].max() if is_linear(view) else np.inf
    why = (
        "" if (high <= min(FARTHEST * ends[1], max(crushing, ends[1]))).all() else f"followed to {high.max()}"
    )
    why += "" if (low >= min(ends[0], 0.0)).all() else f"followed from {low.min()}"
    return [
        (line, why or wrong)
        for line, wrong in ranges(page, "are followed down to F = RANGE and up to RANGE;", low, high)
    ]


def is_linear(view):
    """Whether the rods of a file are of linear material, which the force F = k1 crushes."""
    return view.config.get("material", {}).get("law", "linear") == "linear"


def _one_rod(view, page, fine, own, true):
    found, at = [], -1
    for line in page:
        if match := re.match(r"branch (\d+),", line):
            at = int(match[1]) - 1
            found += _branch_line(view, page, line, own[at], true[at])
            page.mark(line, match.span(1))
        elif line.startswith("  stable cycles at"):
            found += _ranges_line(page, line, true[at].stable_ranges)
            found += [(line, _unstable(view, true[at].stable_ranges, 0))]
        elif line.startswith("  no stable cycle"):
            found.append((line, f"there are at {true[at].stable_ranges}" if true[at].stable_ranges else ""))
        elif match := re.match(rf"  ({'|'.join(KINDS)})(?:, where branch (\d+) meets it,)? at F", line):
            found += _special_line(page, line, KINDS[match[1]], true[at])
            if match[2]:
                page.mark(line, match.span(2))
        elif line.startswith("stable cycles beside a stable straight rod:"):
            common = _beside(fine, 0)
            found += _ranges_line(page, line, common) + [(line, _growing(view, common, 0))]
        elif line.startswith("two stable cycles, on different branches, at"):
            found += _ranges_line(page, line, _pairs(true))
    return found


def _branch_line(view, page, line, own, true):
    """From where to where a branch leads, its cycles, and how wide they beat."""
    first, last, found = true.special_points[0], true.special_points[-1], []
    places = read(page, rf"F = NUMBER \(\+- ({NUMBER})\)", only=line)
    ends = (last,) if first.kind == "end" else (first, last)
    for _, match in read(page, "from beyond [a-z ]*, F = NUMBER,", only=line):
        found.append((line, as_stated(match[1], first.at)))
    for place, special in zip(places, ends, strict=False):
        found.append((line, with_error(place[1][1], place[1][2], special.at)))
    for word, reason in LEADS_TO.items():
        if f"to {word}, F =" in line:
            found.append((line, "" if reason in (last.reason, last.kind) else f"it ends by {last.reason}"))
            for _, match in read(page, rf"to {word}, F = NUMBER:", only=line):
                found.append((line, as_stated(match[1], last.at)))
    cycles = own.is_cycle
    for _, match in read(page, r": NUMBER cycles?, F = RANGE, largest tip y RANGE L", only=line):
        why = [] if int(match[1]) == cycles.sum() else [f"there are {cycles.sum()} cycles"]
        why.append(range_as_stated(match[2], own.parameter[cycles]))
        why += [
            _size(true, own, text, pick)
            for text, pick in zip(_ends(match[3]), (np.argmin, np.argmax), strict=True)
        ]
        found.append((line, "; ".join(filter(None, why))))
    found += [(line, "") for _ in read(page, r"from branch NUMBER|to branch NUMBER", only=line)]
    return found


def _ends(text):
    low, _, high = text.partition(" to ")
    return low, high or low


def _size(true, own, text, pick):
    """Why the smallest or the largest of the stored sizes is not that of the true branch at its place."""
    i = pick(np.where(own.is_cycle, own.tip_y_max, np.inf if pick is np.argmin else -np.inf))
    at, y = float(own.parameter[i]), float(own.tip_y_max[i])
    s = np.concatenate(
        [
            [0.0],
            np.cumsum(
                np.hypot(
                    np.diff(true.parameter) / np.ptp(true.parameter),
                    np.diff(true.tip_y_max) / np.ptp(true.tip_y_max),
                )
            ),
        ]
    )
    step = np.linspace(0, s[-1], 20001)
    along, sizes = (
        np.interp(step, s, values) for values in (true.parameter, true.tip_y_max**2)
    )  # y^2 is smooth at Hopf points
    near = np.flatnonzero(np.diff(np.sign(along - at)) != 0)
    places = np.append(near, np.argmin(np.abs(along - at)))
    size = min(np.sqrt(sizes[places]), key=lambda one: abs(one - y))
    return as_stated(text, size, CURVED * size + 0.02 * np.ptp(true.tip_y_max) * (len(true.parameter) < 12))


def _special_line(page, line, kind, true):
    """A special point with its errors."""
    found = []
    stated = rf"F = NUMBER \(\+- ({NUMBER})\), period (?:NUMBER|({NUMBER}) \(\+- ({NUMBER})\)) tau2"
    for _, match in read(
        page, stated + rf", largest tip y (?:NUMBER|({NUMBER}) \(\+- ({NUMBER})\)) L", only=line
    ):
        at = float(match[1])
        near = min((s for s in true.special_points if s.kind == kind), key=lambda s: abs(s.at - at))
        why = [with_error(match[1], match[2], near.at)]
        for (plain, stated_, error), value in zip(
            ((match[3], match[4], match[5]), (match[6], match[7], match[8])),
            (near.period, near.tip_y_max),
            strict=True,
        ):
            why.append(as_stated(plain, value) if plain else with_error(stated_, error, value))
        found.append((line, "; ".join(filter(None, why))))
    return found or [(line, "nothing reads the special point")]


def _ranges_line(page, line, true):
    """A list of ranges, or that there is none."""
    told = line.split("F = ", 1)[1] if "F = " in line else ""
    offset = len(line) - len(told)
    stated = [match for match in re.finditer(rf"({NUMBER}) to ({NUMBER})", told)]
    for match in stated:
        for group in (1, 2):
            page.mark(line, tuple(offset + place for place in match.span(group)))
    if len(stated) != len(true):
        return [(line, f"the ranges are {true}")]
    why = [
        as_stated(text, value)
        for match, ends in zip(stated, true, strict=True)
        for text, value in zip(match.groups(), ends, strict=True)
    ]
    return [(line, "; ".join(filter(None, why)))]


def _beside(fine, rod):
    """Where stable cycles are beside a stable straight rod."""
    stable = union_of_ranges(
        piece for curve in RodBranches(fine, rod).curves for piece in curve.stable_ranges
    )
    return intersection_of_ranges(
        stable, RodBranches(fine, rod).straight_rod_stable_unstable_ranges(followed_range(fine))[0]
    )


def _pairs(curves):
    ranges_ = [curve.stable_ranges for curve in curves]
    return union_of_ranges(
        piece
        for i in range(len(ranges_))
        for j in range(i)
        for piece in intersection_of_ranges(ranges_[i], ranges_[j])
    )


def _rod(view, rod, F):
    columns = view.point_columns
    return rod_of(F, *(float(columns[name][rod]) for name in ("k1", "k2", "gamma3")))


def _growing(view, some, rod):
    """Why the straight rod is not stable in the middle of ranges that say so."""
    for low, high in some:
        rate = leading(_rod(view, rod, (low + high) / 2))[0].real
        if rate > 0:
            return f"the straight rod grows at {rate} at {(low + high) / 2}"
    return ""


def _unstable(view, some, rod):
    """Why no stable cycle is found by motions in the middle of ranges that say so."""
    columns = view.point_columns
    given = {name: float(columns[name][rod]) for name in ("k1", "k2", "gamma3", "gamma1")}
    for low, high in some:
        F = (low + high) / 2
        if high - low < DECIDED * high:
            continue
        ends = []
        for start in ({}, {"amplitude": 0.3}):
            data = rs.sweep("limit_cycle", F=F, **given, accuracy=1e-4, progress=False, **start)
            flags = data.status.attrs
            words = dict(
                zip(np.ravel(flags["flag_values"]).tolist(), flags["flag_meanings"].split(), strict=True)
            )
            ends.append(words[int(data.status.values.ravel()[0])])
            if ends[-1] == "cycle":
                break
        else:
            return f"motions at F = {F} end {ends}"
    return ""


def first_end(curve):
    """1 for a branch that begins at an end of the range, beyond which it comes from; else 0."""
    return int(curve.special_points[0].kind == "end")


def _grid(view, page, fine, own, true):
    count = len(true)
    curves = [curve for each in own.values() for curve in each]
    with_one = sum(bool(each) for each in own.values())
    cycles = int(sum(curve.is_cycle.sum() for curve in curves))
    found = counts(
        page,
        r"^NUMBER branch(?:es)? at NUMBER of NUMBER rods?, NUMBER cycles?",
        len(curves),
        with_one,
        count,
        cycles,
    )
    stored = view.variables
    sizes = [stored[name][np.isfinite(stored[name])] for name in ("period", "tip_y_max")]
    # The cycles of a finer branch are at other places.
    found += ranges(page, "cycles: period RANGE tau2, largest tip y RANGE L", *sizes)
    specials = [
        (rod, s)
        for rod, each in true.items()
        for number, curve in enumerate(each, 1)
        for s in curve.special_points[first_end(curve) :]
        if not 0 < s.meets < number
    ]
    entries = [curve.special_points[0].at for each in true.values() for curve in each if first_end(curve)]
    for line, match in read(page, r"^NUMBER branch(?:es)? enters? the range from beyond: F = RANGE"):
        why = [] if int(match[1]) == len(entries) else [f"there are {len(entries)}"]
        found.append((line, "; ".join(filter(None, [*why, range_as_stated(match[2], entries)]))))
    for words, kind in PLURALS.items():
        at = [s.at for _, s in specials if s.kind == kind]
        for line, match in read(page, rf"^NUMBER (?:{words}): F = RANGE"):
            why = [] if int(match[1]) == len(at) else [f"there are {len(at)}"]
            found.append((line, "; ".join(filter(None, [*why, range_as_stated(match[2], at)]))))
    for words, reason in LEADS_TO.items():
        at = [s.at for _, s in specials if reason in (s.kind, s.reason)]
        for line, match in read(page, rf"^NUMBER branch(?:es)? ends? at {words}: F = RANGE"):
            why = [] if int(match[1]) == len(at) else [f"there are {len(at)}"]
            found.append((line, "; ".join(filter(None, [*why, range_as_stated(match[2], at)]))))
    for words, of in (
        ("stable cycles beside a stable straight rod", _beside),
        ("two stable cycles, on different branches,", lambda f, r: _pairs(true[r])),
    ):
        having = {rod: some for rod in true if (some := of(fine, rod))}
        found += counts(page, rf"^{words} at NUMBER of NUMBER rod", len(having), count)
        begins = [i for i, line in enumerate(page) if line.startswith(f"{words} at")]
        if begins and having:
            lines = page[begins[0] + 1 : begins[0] + 1 + len(having)]
            for line, (rod, some) in zip(lines, having.items(), strict=True):
                found += _ranges_line(page, line, some) + [(line, _growing(view, some, rod))]
                read(page, r"^  \w+ = NUMBER: ", only=line)
    return found
