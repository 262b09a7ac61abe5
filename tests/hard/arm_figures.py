"""Figures over the quantities of arms: numbers of rods, converted here anew to the units of the labels."""

import re
from math import pi

import numpy as np
from matplotlib.collections import Collection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.contour import ContourSet
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from rodsweep.model.arm.drag import DRAG_ESTIMATE_NAMES
from rodsweep.model.arm.neglected import Validity

from .arm_sentences import NAMED, UNIT, UNITS_AND_EXAMPLES, force_unit, in_si, quantities_at_points
from .drawing import (
    PARAMETERS,
    cells,
    changes_to,
    colour_of,
    first_forces,
    one_of,
    plain,
    roots_of,
    unit_factor,
    unloaded,
    words_of,
    xy,
)
from .page import read
from .truths import rods_of

ARM_LABELS = {"Young's modulus": "young", "Poisson's ratio": "poisson"}
STATUS_COVERS = {
    "shorter than 10 radii": "not_slender",
    "crushed": "crushed",
    "no flutter": "no_flutter",
    "flutter unknown": "flutter_unknown",
    "no wall": "no_wall",
}


def arm_figure(d, gridded, view, fine):
    """Lines or maps over the quantities of an arm: numbers of rods, converted to the units of labels."""
    found, scales = [], in_si(view)
    here, band = _drawn_arms(d, gridded, view)
    for axes in d.panels:
        x, y = (_quantity(d.label(axes, which), view) for which in "xy")
        meshes, label = d.take(axes, QuadMesh), d.label(axes, "y")
        if meshes:
            label = next(
                plain(a.get_ylabel())
                for a in d.figure.axes
                if getattr(a, "_colorbar", None) and a._colorbar.mappable is meshes[0]
            )
        numbers = _arm_numbers(view, label, scales)
        covers = d.take(
            axes,
            Collection,
            lambda one: not isinstance(one, ContourSet) and (one.get_hatch() or one.get_alpha() is None),
        )
        if meshes:
            (values,) = (
                values
                for word, values in numbers.items()
                if not word or len(numbers) == 1 or word == "flutter"
            )
            found.append((label, cells(d, axes, meshes[0], (x[here], y[here]), values[here])))
            for zero in d.take(axes, ContourSet):
                vertices = np.concatenate([path.vertices for path in zero.get_paths()])
                d.marks += len(vertices)
                sign = np.nanmin(values[here]) < 0 < np.nanmax(values[here])
                found.append((label, "" if sign and len(vertices) else "no growth rate changes its sign"))
            found += _covers(d, axes, covers, (x, y), here, view, values)
            continue
        handles = {colour_of(h): t for h, t in d.legend_entries() if isinstance(h, Line2D)}
        for line in d.lines(axes):
            word = handles.get(colour_of(line), "") if len(numbers) > 1 else ""
            values = numbers.get(word, next(iter(numbers.values())))
            there = here & np.isfinite(values)
            found.append((f"{label} {word}", d.compare(axes, xy([line]), (x[there], values[there]))))
            for area in d.take(axes, Collection, lambda one, line=line: colour_of(one) == colour_of(line)):
                found.append((f"band of {label}", _band(d, axes, area, x, values, band)))
        found += _covers(d, axes, covers, (x, None), here, view, None)
    d.left = {mark: of for mark, of in d.left.items() if _has_area(mark)}
    return found


def _has_area(mark):
    return (
        not isinstance(mark, Collection)
        or isinstance(mark, QuadMesh)
        or any(np.isfinite(path.vertices).all() and len(path.vertices) for path in mark.get_paths())
    )


def _quantity(label, view):
    """The values of the quantity along an axis, at every point in the unit of its label; None without one."""
    name = re.sub(r" ?\([^)]*\)$", "", label)
    name = ARM_LABELS.get(name, name.replace(" ", "_"))
    each = quantities_at_points(view)
    if label in PARAMETERS:
        return view.point_columns[PARAMETERS[label]]
    if name not in each[0]:
        return None
    return np.array([q[name] for q in each]) / (unit_factor(label) or 1.0)


def _arm_numbers(view, label, scales):
    """What a label names, at every point in its unit, by what the legend says of several lines."""
    factor, hertz, v = unit_factor(label), 1 / (2 * pi * scales["tau2"]), view.variables
    if re.match(r"(pressure|force)( at flutter)? \(", label):
        forces = first_forces(view)
        words = {"flutter": "hopf", "onset of oscillations": "onset", "return": "restabilization"}
        return {word: forces[kind] * scales[force_unit(view)] / factor for word, kind in words.items()}
    if label.startswith("frequency at flutter"):
        found = [
            next((c.frequency for c in changes_to(rod, top) if c.kind.name == "hopf"), np.nan)
            for rod, top in unloaded(view)
        ]
        return {"": np.array(found) * hertz}
    known = v["status"].ravel() == 0
    if view.task == "limit_cycle":
        cycle = np.isin(words_of(view), ("cycle", "unstable"))
        number = (
            v["frequency"].ravel() * hertz
            if label.startswith("frequency")
            else v["tip_y_max"].ravel() * scales["length"] / factor
        )
        straight = words_of(view) == "straight"
        return {
            "": np.where(
                cycle,
                number,
                np.where(straight & ~label.startswith("frequency"), v["tip_y_max"].ravel(), np.nan),
            )
        }
    w = np.array(
        [roots_of(rod, 2)[0] if ok else np.nan for rod, ok in zip(rods_of(view), known, strict=True)]
    )
    return {"": w.real / scales["tau2"] if "growth rate" in label else np.abs(w.imag) * hertz}


def _drawn_arms(d, gridded, view):
    """(which points are drawn, which the band is of): the first along axes that the figure has not."""
    shape, on_axes = view.variables["status"].shape, set()
    for axes in d.panels:
        for which in "xy":
            name = re.sub(r" ?\([^)]*\)$", "", d.label(axes, which))
            name = ARM_LABELS.get(name, PARAMETERS.get(d.label(axes, which), name.replace(" ", "_")))
            on_axes |= {name} & set(gridded.arm_axes)
    sizes = [len(gridded.variables[name]) for name in gridded.arm_axes]
    at = np.indices(sizes).reshape(len(sizes), -1)
    here, band = np.ones(at.shape[1], bool), np.ones(at.shape[1], bool)
    for name, places in zip(gridded.arm_axes, at, strict=True):
        if name not in on_axes:
            first = int(np.argmin(gridded.variables[name])) if name == "drag" else 0
            here &= places == first
            band &= (places == first) | (name == "drag")
    assert shape == here.shape
    return here, band


def _band(d, axes, area, x, values, band):
    """Why a band is not that from the least to the largest number over the drags."""
    true = []
    for place in np.unique(x[band]):
        some = values[band & (x == place)]
        true += (
            [(place, end) for end in (np.nanmin(some), np.nanmax(some))] if np.isfinite(some).any() else []
        )
    vertices = np.concatenate([path.vertices for path in area.get_paths()])
    return d.compare(axes, vertices.T, np.array(true).reshape(-1, 2).T)


def _covers(d, axes, covers, at, here, view, values):
    """The hatches of cells, against where the model applies and what became of the points."""
    found = []
    entries = [
        (h, t) for h, t in d.legend_entries() if isinstance(h, Patch) and not t.startswith("range of drag")
    ]
    looks = {(h.get_hatch(), to_hex(h.get_facecolor(), keep_alpha=True)): text for h, text in entries}
    middle = np.mean(axes.get_ylim())
    rod = ~np.isin(words_of(view), list(STATUS_COVERS.values()))
    for i in np.flatnonzero(here):
        place = (at[0][i], middle if at[1] is None else at[1][i])
        over = {
            looks.get(
                (
                    each.get_hatch(),
                    to_hex(
                        np.ravel(each.get_facecolor())[:4] if len(each.get_facecolor()) else (0, 0, 0, 0),
                        keep_alpha=True,
                    ),
                )
            )
            for each in covers
            if any(path.contains_point(place, radius=-1e-12) for path in each.get_paths())
        }
        validity = int(np.ravel(view.variables["model_applies"])[i])
        true = {"model doubtful"} if rod[i] and validity == Validity.doubtful else set()
        true |= {"model does not apply"} if rod[i] and validity == Validity.does_not_apply else set()
        true |= {word for word, flag in STATUS_COVERS.items() if words_of(view)[i] == flag}
        empty = values is not None and rod[i] and np.isnan(values[i])
        own = over - {"no flutter", "no cycle", "nothing computed"} if empty else over
        d.marks += 1
        found.append(
            (f"cover at {place}", "" if own == true and bool(over - own) == empty else f"{over} is {true}")
        )
    return found


def quantities_told(d, view):
    """The check of an arm's quantities in texts."""
    found, each = [], quantities_at_points(view) if view.quantities else []
    if not each:
        return found
    for line, match in read(d.page, r"drag ([a-z ]+?)(?: \(of NUMBER values\))?(?=,| and |$)"):
        names = {DRAG_ESTIMATE_NAMES[int(q["drag"])].replace("_", " ") for q in each if "drag" in q}
        found.append((line, "" if match[1] in names else f"drags {names}"))
    for line, match in read(
        d.page,
        rf"(?:^|, |(?<=\D) )([A-Za-z' ]+?) NUMBER(?: ({UNIT}|g/cm\^3|kg/m\^3))?"
        r"(?: \(of NUMBER values\))?(?=,| |$)",
    ):
        name = NAMED.get(match[1], match[1].strip().replace(" ", "_"))
        if name in each[0]:
            values = np.unique([q[name] for q in each]) / UNITS_AND_EXAMPLES.get(match[3], 1.0)
            why = one_of(match[2], values, 4)
            found.append(
                (line, why if not match[4] or int(match[4]) == len(values) else f"{len(values)} values")
            )
    return found
