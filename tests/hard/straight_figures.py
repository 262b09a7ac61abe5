"""Figures of straight rods: spectra, modes, thresholds, normal forms, phase diagrams, against the solvers."""

import re
from dataclasses import replace

import numpy as np
from matplotlib.collections import Collection, PathCollection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.contour import ContourSet
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Annotation
from scipy.spatial import cKDTree

import rodsweep as rs
from rodsweep.model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES
from rodsweep.model.rod import Rod

from .drawing import (
    CRITICAL,
    LINE,
    PARAMETERS,
    SAME,
    cell_of,
    cells,
    changes_to,
    chosen,
    class_of,
    colour_of,
    first_forces,
    nearly,
    one_of,
    parameters_told,
    plain,
    reads,
    rods_of_line,
    roots_of,
    told,
    unloaded,
    xy,
)
from .page import NUMBER, read, unit_of
from .truths import changes_along, rods_of


def spectrum_figure(d, view, _):
    rods, columns, found = rods_of(view), view.point_columns, []
    modes, known = len(view.variables["mode"]), np.isfinite(view.variables["growth_rate"])
    w = np.array([roots_of(rod, modes) for rod in rods])
    w = np.where(known.reshape(w.shape), w, np.nan)
    for axes in d.panels:
        x, y = d.label(axes, "x"), d.label(axes, "y")
        here = chosen(columns, told(axes.get_title("left") and plain(axes.get_title("left"))))
        d.zeros(axes)
        if x == "Re w tau2":
            why = _roots_in_plane(d, axes, w[here], columns)
        elif y == "w tau2":
            why = _roots_over(d, axes, PARAMETERS[x], columns, rods, here, w)
        elif y in ("Re w tau2", "Im w tau2"):
            part = w.real if y[0] == "R" else w.imag
            at = np.broadcast_to(np.arange(1, len(w) + 1)[:, None], w.shape)
            why = [_growing(d, axes, at, part, w.real > 0)]
        else:
            why = _growth_map(d, axes, (PARAMETERS[x], PARAMETERS[y]), columns, w[:, 0].real)
        found += [(f"{x}, {y}", one) for one in why]
    return found + _numbered(d, w) + parameters_told(d, columns)


def _growing(d, axes, x, y, grows):
    """Marks of growing and decaying modes apart."""
    why = []
    for word, there in (("growing mode", grows), ("decaying mode", ~grows)):
        lines = d.lines(axes, lambda line, word=word: line.get_label() == word)
        why.append(d.compare(axes, xy(lines), (x[there], y[there])))
    return "; ".join(filter(None, why))


def _roots_in_plane(d, axes, w, columns):
    """Marks of one point, or paths of roots over a parameter, in the complex plane."""
    for arrow in d.take(axes, Annotation, lambda note: not note.get_text()):
        yield d.compare(axes, zip(arrow.xy, arrow.xyann, strict=True), (w.real, w.imag), whole=False)
    for dots in d.take(axes, PathCollection):
        yield d.compare(axes, dots.get_offsets().T, (w.real, w.imag))
        (name,) = (name for name, values in columns.items() if len(set(values)) > 1)
        each = np.broadcast_to(columns[name][:, None], w.shape).ravel()
        shown = dots.get_array()
        yield "" if sorted(shown) == sorted(each) else f"colours are not of {name}"
    if len(w) == 1:
        yield _growing(d, axes, w.real, w.imag, w.real > 0)
        for note in d.take(axes, Annotation):
            i = int(note.get_text()) - 1
            near = np.abs(w[0] - complex(*note.xy)) <= 1e-6 * np.abs(w[0, i])
            yield "" if near[i] else f"{note.get_text()} stands at {note.xy}"
    yield d.compare(axes, xy(d.lines(axes)), (w.real, w.imag), whole=False)


def _numbered(d, w):
    """The numbers beside the marks of one point."""
    return [(line, "") for line, _ in read(d.page, r"^NUMBER$")] if len(w) == 1 else []


def _roots_over(d, axes, name, columns, rods, here, w):
    """Roots over a parameter, where the rod is unstable, and its thresholds."""
    x, own = columns[name], w
    here = here & np.isfinite(x)
    x, own = x[here], own[here]
    lines = d.lines(axes)
    for word, part in (("Re w", own.real), ("Im w", own.imag)):
        of = [line for line in lines if plain(line.get_label()).startswith(word)]
        all_of_them = len(of) == 1
        across = np.broadcast_to(x[:, None], part.shape)
        yield d.compare(axes, xy(of), (across, part), whole=all_of_them)
        counts = [np.isfinite(line.get_xydata()).all(axis=1).sum() for line in of]
        there = np.isfinite(part[:, 0]).sum()
        yield "" if all_of_them or counts == [there] * len(of) else f"{counts} of {there} points are drawn"
    if len(lines) == 4:
        yield _pairs(lines, x, own, "magnitude" in " ".join(d.page))
    yield from _changes_marked(d, axes, name, rods, here, x, own[:, 0].real)


def _pairs(lines, x, w, smallest):
    """Why the two roots that are drawn are not those that are named."""
    drawn = np.array([line.get_ydata() for line in lines])
    there = np.isfinite(drawn).all(axis=0)
    at = np.asarray(lines[0].get_xdata())[there]
    drawn = (drawn[0::2] + 1j * drawn[1::2])[:, there].T
    for place, roots in zip(at, drawn, strict=True):
        own = w[np.argmin(np.abs(x - place))]
        order = np.argsort(np.round(np.abs(own), 9) if smallest else -own.real, kind="stable")
        sizes = [np.abs(own[order[:2]]), np.abs(roots)] if smallest else [own.real[order[:2]], roots.real]
        if not np.allclose(np.sort(sizes[0]), np.sort(sizes[1]), rtol=1e-6):
            return f"at {place} it is {own[order[:2]]}, not {roots}"
    return ""


def _changes_marked(d, axes, name, rods, here, x, growth):
    """The lines at thresholds, their numbers, and the shades where the rod is unstable."""
    low, high = float(x.min()), float(x.max())
    rod = rods[int(np.flatnonzero(here)[0])]
    true = changes_along(replace(rod, **{name: low}), name, low, high) if name == "F" and low < high else []
    kinds = {"F*": "onset", "F**": "hopf", "restabilization": "restabilization"}
    for at, line in d.verticals(axes):
        word, _, number = plain(line.get_label()).partition(" = ")
        if not number:  # of several panels: the title of each has the numbers
            told = re.findall(rf"(F\*\*?|restabilization) = ({NUMBER})", d.title(axes))
            right = [
                (text, symbol)
                for symbol, text in told
                if (symbol == "F*") == (word == "onset of oscillation")
            ]
            number, word = min(right, key=lambda pair: abs(float(pair[0]) - at))
        kind = kinds[word.strip()]
        near = min((c.value for c in true if c.kind.name == kind), key=lambda c: abs(c - at), default=np.inf)
        yield d.compare(axes, ([at], [0.0]), ([near], [0.0]), LINE) if near < np.inf else f"no {kind} at {at}"
        yield nearly(number, near)
        texts = [text for text in d.page if f"{word.strip()} = {number}" in text]
        yield "" if texts else f"{word} is nowhere told"
        for text in texts:
            start = text.index(f"{word.strip()} = {number}") + len(f"{word.strip()} = ")
            d.page.mark(text, (start, start + len(number)))
    shades = d.take(axes, Collection | Patch, lambda mark: colour_of(mark) == "#ebebeb")
    inside = np.zeros(len(x), bool)
    for shade in shades:
        for path in shade.get_paths() if isinstance(shade, Collection) else [shade.get_path()]:
            corners = (
                path.vertices
                if isinstance(shade, Collection)
                else shade.get_patch_transform().transform(path.vertices)
            )
            left, right = corners[:, 0].min(), corners[:, 0].max()
            rounding = SAME * (right - left)
            inside |= (x >= left - rounding) & (x <= right + rounding)
            edges = np.concatenate([[c.value for c in true], x])
            yield d.compare(axes, ([left, right], [0, 0]), (edges, np.zeros(len(edges))), LINE, whole=False)
    wrong = (inside != (growth > 0)) & np.isfinite(growth) & (growth != 0)
    yield f"shade and growth differ at {x[wrong]}" if wrong.any() else ""


def _growth_map(d, axes, names, columns, growth):
    """Levels of the growth rate over two parameters, and its line of zero."""
    levels, *zero = sorted(d.take(axes, ContourSet), key=lambda each: -len(each.levels))
    x, y = (columns[name] for name in names)
    d.marks += len(x)
    for dots in d.take(axes, PathCollection, lambda one: not one.get_visible()):  # values that a report shows
        own = np.column_stack([x, y])[np.isfinite(x + y)]
        right = sorted(map(tuple, dots.get_offsets().data)) == sorted(map(tuple, own))
        shown = np.sort(np.ma.filled(dots.get_array(), np.nan))
        right &= np.allclose(shown, np.sort(growth), rtol=SAME, atol=SAME, equal_nan=True)
        yield "" if right else "the points under the map are not those of the file"
    inner = (x > x.min()) & (x < x.max()) & (y > y.min()) & (y < y.max()) & np.isfinite(x + y)
    size = np.nanmax(np.abs(growth))
    for i in np.flatnonzero(inner)[:: max(1, inner.sum() // 40)]:
        level = [k for k, path in enumerate(levels.get_paths()) if path.contains_point((x[i], y[i]))]
        bounds = [(levels.levels[k] - SAME * size, levels.levels[k + 1] + SAME * size) for k in level]
        right = any(low <= growth[i] <= high for low, high in bounds)
        yield (
            "" if right or not level else f"{growth[i]} at {names} = {x[i], y[i]} has the colour of {bounds}"
        )
    for line in zero:
        vertices = np.concatenate([path.vertices for path in line.get_paths()])
        d.marks += len(vertices)
        each = [np.unique(values[np.isfinite(values)]) for values in (x, y)]
        for place in vertices[:: max(1, len(vertices) // 30)]:
            beside = [
                (values[values <= p * (1 + 1e-9)].max(), values[values >= p * (1 - 1e-9)].min())
                for values, p in zip(each, place, strict=True)
            ]
            corner = np.isin(x, beside[0]) & np.isin(y, beside[1])
            yield "" if growth[corner].min() <= 0 <= growth[corner].max() else f"no change of sign at {place}"
    yield "" if bool(zero) == (np.nanmin(growth) < 0 < np.nanmax(growth)) else "the line of zero is missing"


FIELDS = {
    "Y1": "Y",
    "Theta1": "Theta",
    "h2": "h2",
    "Pi": "Pi",
    "Y1^+": "adjoint_Y",
    "Theta1^+": "adjoint_Theta",
}


def modes_figure(d, view, fine):
    v, columns, found = fine().variables, view.point_columns, []
    w = np.array([roots_of(rod, 2)[0] for rod in rods_of(view)])
    hosts = [axes for axes in d.panels if axes.yaxis.get_ticks_position() != "right"]
    rows = [hosts[i : i + 3] for i in range(0, len(hosts), 3)]
    at = np.flatnonzero(np.isfinite(view.variables["growth_rate"][..., 0].ravel()))[: len(rows)]
    for point, row in zip(at, rows, strict=True):
        title = d.title(row[1])
        found.append((title, "" if chosen(columns, told(title), 4)[point] else f"it is point {point}"))
        found += _eigenvalue_told(d, title, w[point])
        places = [axes.get_position().bounds for axes in row]
        for axes in d.panels:
            if axes.get_position().bounds not in places:
                continue
            d.zeros(axes)
            name = FIELDS[plain(axes.get_ylabel())]
            parts = (
                v[f"{name}_{part}"].reshape(len(columns["F"]), -1, len(v["u"]))[point, 0]
                for part in ("real", "imag")
            )
            for part, style in zip(parts, ("-", ":"), strict=True):
                lines = d.lines(axes, lambda line, style=style: line.get_linestyle() == style)
                true = (v["u"], part) if lines or part.any() else (np.zeros(0), np.zeros(0))
                found.append((name, d.compare(axes, xy(lines), true, LINE)))
    found += [(line, "") for line, _ in read(d.page, r"of the first(?: NUMBER)? of NUMBER points")]
    return found + parameters_told(d, columns, 4)


def _eigenvalue_told(d, title, w):
    """The leading eigenvalue above a panel."""
    found = []
    for line in d.page:
        if line in title:
            for _, match in read(d.page, r"w1tau2 = NUMBER(?: \+ NUMBER i)?", only=line):
                imaginary = match[2] or "0"
                found.append((line, nearly(match[1], w.real) or nearly(imaginary, abs(w.imag))))
    return found


ALIKE = 0.01
"""Fraction of an axis within which several rods have one line, if the legend says so."""
MARKERS_OF_FORCES = {"o": "onset", "s": "hopf", "^": "restabilization"}


def thresholds_figure(d, view, _):
    searched = reads(
        d,
        r"searched up to F = NUMBER(?: to NUMBER)?",
        lambda m: (
            nearly(m[1], np.nanmin(view.variables["F_end"]), 4)
            or (m[2] and nearly(m[2], np.nanmax(view.variables["F_end"]), 4))
        ),
    )
    searched += [
        (line, "")
        for line, _ in read(d.page, r"lines for NUMBER of NUMBER values of \w+ and NUMBER of NUMBER values")
    ]
    if any(isinstance(mark, Patch) for mark in d.left):
        return searched + _bars(d, view)
    forces, columns, found = first_forces(view), view.point_columns, []
    for axes in d.panels:
        x, y = (PARAMETERS.get(d.label(axes, which), d.label(axes, which)) for which in "xy")
        meshes = d.take(axes, QuadMesh)
        if meshes:
            bar = next(
                plain(a.get_ylabel())
                for a in d.figure.axes
                if getattr(a, "_colorbar", None) and a._colorbar.mappable is meshes[0]
            )
            kind = CRITICAL[bar.removesuffix(" in k3/L^2")]
            found.append((bar, cells(d, axes, meshes[0], (columns[x], columns[y]), forces[kind])))
            continue
        at = 1 / columns["gamma3"] if x == "1/gamma3" else columns[x]
        entries = d.legend_entries() + d.legend_entries(axes)
        for line in d.lines(axes):
            kind = MARKERS_OF_FORCES.get(line.get_marker())
            here = rods_of_line(line, entries, columns)
            there = here & np.isfinite(at) & np.isfinite(forces[kind])
            alike = any("one line" in text for _, text in entries)
            places = at[there], forces[kind][there]
            found.append((f"{kind} over {x}", d.compare(axes, xy([line]), places, whole=not alike)))
            if alike:
                found.append((f"{kind} over {x}", d.compare(axes, places, xy([line]), ALIKE, whole=False)))
        silent = [
            k
            for k, values in forces.items()
            if np.isfinite(values).any() and not any(CRITICAL.get(t) == k for _, t in d.legend_entries())
        ]
        found.append((x, f"the legend lacks {silent}" if silent else ""))
        low = axes.get_ylim()[0]
        found.append((y, "" if y == "critical force F" or not y else "the label"))
        found.append((y, "" if low == 0 else f"forces begin at {low}"))
    return searched + found + _values_of_lines(d, columns) + parameters_told(d, columns)


def _values_of_lines(d, columns):
    """The check of the values that the legend of a panel gives, to three digits, several for one line."""
    found = []
    for text in {text for axes in d.panels for _, text in d.legend_entries(axes)}:
        for line, match in read(d.page, r"^(\w+) = NUMBER(?:, NUMBER)?(?:, NUMBER)?", only=text):
            why = (one_of(number, columns[match[1]], 3) for number in match.groups()[1:] if number)
            found.append((line, "; ".join(filter(None, why))))
    return found


def _bars(d, view):
    """Bars of classes over F, marks at thresholds, and their numbers."""
    (axes,), found = d.panels, []
    rods = unloaded(view)
    upright = len(rods) > 1
    words = {colour_of(handle): text for handle, text in d.legend_entries() if isinstance(handle, Patch)}
    bars = d.take(axes, Patch)
    covered = np.zeros(len(rods))
    for bar in bars:
        (x, y), width, height = bar.get_xy(), bar.get_width(), bar.get_height()
        start, end, place = (y, y + height, x + width / 2 - 1) if upright else (x, x + width, y + height / 2)
        rod, top = rods[round(place)]
        d.marks += 1
        covered[round(place)] = max(covered[round(place)], end)
        edges = np.array([0.0, top, *(c.value for c in changes_to(rod, top))])
        off = max(np.abs(edges - at).min() for at in (start, end)) / top
        found.append((f"bar {start} to {end}", "" if off <= SAME else f"an end is off by {off}"))
        word = words.get(colour_of(bar))
        true = class_of(replace(rod, F=(start + end) / 2))
        allowed = (true, "undecided", "not stored")
        found.append((f"bar {start} to {end}", "" if word in allowed else f"{word} is {true}"))
    found.append(("bars", "" if np.allclose(covered, [top for _, top in rods]) else f"bars end at {covered}"))
    for line in d.lines(axes):
        word = plain(line.get_label()).partition(" = ")[0]
        places = []
        for i, (rod, top) in enumerate(rods):
            for c in changes_to(rod, top):
                kind = c.kind.name if c.kind.name != "hopf" or c.unstable_after <= 2 else "further Hopf point"
                if kind == CRITICAL.get(word, word.removesuffix("s")):
                    places.append((i + 1, c.value) if upright else (c.value, i))
        found.append((word, d.compare(axes, xy([line]), np.array(places).reshape(-1, 2).T)))
        for text, match in [] if upright else read(d.page, rf"^{re.escape(word)} = (.*)$"):
            numbers = match[1].split(", ")
            true = [place[0] for place in places]
            why = "" if len(numbers) == len(true) else f"it is {true}"
            found.append((text, why or "; ".join(filter(None, map(nearly, numbers, true)))))
    return found + parameters_told(d, view.point_columns)


SIDES = {"supercritical": -1, "subcritical": 1, "criticality undecided": 0}


def criticality_figure(d, view, fine):
    v, columns, found = fine().variables, view.point_columns, []
    own = {
        name: view.variables[name].reshape(view.variables["status"].size, -1)
        for name in ("criticality", "crossing_F", "amplitude_coefficient", "landau_real")
    }
    v = {name: v[name].reshape(own[name].shape) for name in own}
    for axes in d.panels:
        x, y = (d.label(axes, which) for which in "xy")
        d.zeros(axes)
        meshes = d.take(axes, QuadMesh)
        if meshes:
            found.append(
                (
                    x,
                    _criticality_map(
                        d, axes, meshes[0], (columns[PARAMETERS[x]], columns[PARAMETERS[y]]), own
                    ),
                )
            )
        elif y.startswith("predicted"):
            found += _predictions(d, axes, v, columns)
        else:
            values = own["amplitude_coefficient" if y.startswith("amplitude") else "landau_real"]
            at = np.broadcast_to(columns[PARAMETERS[x]][:, None], values.shape)
            for word, side in SIDES.items():
                lines = d.lines(axes, lambda line, word=word: line.get_label() == word)
                there = (own["criticality"] == side) & np.isfinite(at)
                found.append((word, d.compare(axes, xy(lines), (at[there], values[there]))))
    found += [
        (line, "") for line, _ in read(d.page, r"within NUMBER% of every|of the first NUMBER of NUMBER rods")
    ]
    return found + parameters_told(d, columns)


def _criticality_map(d, axes, mesh, at, v):
    """Classes by side, or sizes of coefficients, of the first Hopf points."""
    first = v["criticality"][:, 0]
    if mesh.get_cmap().N > 10:
        return cells(d, axes, mesh, at, np.abs(v["amplitude_coefficient"][:, 0]))
    words = {to_hex(handle.get_facecolor()): text for handle, text in d.legend_entries()}
    later = (v["criticality"][:, 1:] == 1).any(axis=1)
    true = [
        "supercritical, a later Hopf point subcritical"
        if side == -1 and more
        else {-1: "supercritical", 1: "subcritical", 0: "criticality undecided"}.get(
            side, "no Hopf point with a normal form"
        )
        for side, more in zip(first, later, strict=True)
    ]
    near, why = cell_of(d, axes, mesh, at)
    colours = mesh.to_rgba(mesh.get_array()).reshape(-1, 4)[near]
    true = [word for word, here in zip(true, np.isfinite(at[0]) & np.isfinite(at[1]), strict=True) if here]
    shown = [words.get(to_hex(colour)) for colour in colours]
    return why if shown == true else f"{shown} are {true}"


def _predictions(d, axes, v, columns):
    """Cycles beside Hopf points by their normal forms, of the rods that the legend names."""
    entries = [(handle, text) for handle, text in d.legend_entries() if isinstance(handle, Line2D)]
    styles = {handle.get_linestyle(): SIDES[text] for handle, text in entries if text in SIDES}
    found, true, drawn = [], [], []
    for line in d.lines(axes):
        of = [told(text) for handle, text in entries if told(text) and colour_of(handle) == colour_of(line)]
        here = chosen(columns, of[0]) if of else np.ones(len(columns["k1"]), bool)
        F, a, side = (
            v[name][here].ravel() for name in ("crossing_F", "amplitude_coefficient", "criticality")
        )
        if line.get_marker() == "o":
            drawn += list(line.get_xdata())
            found.append(("Hopf point", d.compare(axes, xy([line]), (F, np.zeros(len(F))), whole=False)))
            continue
        x, y = xy([line])
        i = int(np.nanargmin(np.abs(F - x[0])))
        true.append(float(F[i]))
        law = np.abs(a[i]) * np.sqrt(np.abs(x / F[i] - 1))
        found.append((f"law at F = {F[i]}", d.compare(axes, (x, y), (x, law), LINE)))
        way = np.sign(x[-1] - x[0]) == np.sign(a[i]) and styles.get(line.get_linestyle()) == side[i]
        found.append((f"law at F = {F[i]}", "" if way else "it is on the other side"))
    return found + [
        (
            "Hopf points",
            ""
            if sorted(true) == sorted(map(float, drawn))
            or np.allclose(sorted(true), sorted(drawn), rtol=1e-9)
            else f"{drawn} are {true}",
        )
    ]


STATE_WORDS = {
    1: "only straight rod stable",
    2: "only cycle stable",
    3: "rod and cycle stable",
    0: "no stable state known",
    4: "undecided",
    5: "crushed",
    -1: "not computed",
}
BESIDE_EDGE = 5
"""Pixels from another class within which no pixel is compared."""
PLACES = 60
"""Places of a map whose class is computed."""
SPECIAL = {
    "folds of cycles, on no curve": 2,
    "torus points of cycles, on no curve": 3,
    "symmetry breakings of cycles": 4,
}


def diagram_figure(d, view, _):
    v, columns, found = view.variables, view.point_columns, []
    (axes,) = d.panels
    line = next(name for name in NON_OPTIONAL_LINEAR_PARAMETER_NAMES if name not in view.parameters)
    row = next((name for name in view.parameters if len(view.parameter_values[name]) > 1), view.parameters[0])
    fixed = {
        name: float(view.parameter_values[name][0])
        for name in view.parameters
        if name in NON_OPTIONAL_LINEAR_PARAMETER_NAMES and name != row
    }

    def rods(x, y):
        values = fixed | {line: float(x), row: float(y)}
        return Rod(**values) if values["F"] < values["k1"] else None

    words = {colour_of(h): text for h, text in d.legend_entries() if isinstance(h, Patch)}
    for one in d.take(axes, ContourSet, lambda one: any(one.hatches)):
        found.append(("compression", _compressed(one, line, fixed, row)))
    covers = d.take(axes, Collection, lambda one: not isinstance(one, QuadMesh))
    states = "stable_states" in v
    if meshes := d.take(axes, QuadMesh):
        found += _row_bars(d, axes, view, meshes[0], words, rods, row)
        d.take(axes, Line2D, lambda one: colour_of(one) == "#ffffff")
    else:
        (image,) = d.take(axes, AxesImage)
        shown = [[words.get(to_hex(c)) for c in image.cmap(image.norm(np.unique(image.get_array())))]]
        table = dict(zip(np.unique(image.get_array()).tolist(), shown[0], strict=True))
        found += _pixels(d, axes, view, np.asarray(image.get_array()), table, rods, states, covers, row)
    found += _curves(d, axes, view, line, row, rods, states)
    found += _cycle_curves(d, axes, view, line, row)
    gamma1 = {
        "gamma1": np.array(
            [float(v["curve_gamma1"]) if "curve_gamma1" in v else float(view.attributes.get("gamma1", 1.0))]
        )
    }
    return found + parameters_told(d, columns | gamma1)


def _compressed(hatched, line, fixed, row):
    """Why an area is not that of arms that the load compresses by a tenth and more."""
    x, y = np.concatenate([path.vertices for path in hatched.get_paths()]).T
    values = {"taper": 1.0} | fixed | {line: x, row: y}
    ratio = values["F"] / (values["k1"] * np.minimum(values["taper"], 1) ** 2)
    return "" if abs(np.min(ratio) - 0.1) < 0.01 * np.max(ratio) else f"it begins at {np.min(ratio)}"


def _uniform(pixels, i, j):
    part = pixels[
        max(i - BESIDE_EDGE, 0) : i + BESIDE_EDGE + 1, max(j - BESIDE_EDGE, 0) : j + BESIDE_EDGE + 1
    ]
    return (part == pixels[i, j]).all()


def _pixels(d, axes, view, pixels, table, rods, states, covers, row):
    """Classes of places of the plane against those of rods there; stable states at the points of the file."""
    random, found, n = np.random.default_rng(5), [], len(pixels)
    to_data = axes.transAxes + axes.transData.inverted()
    if states:
        y = view.parameter_values[row][np.isfinite(view.parameter_values[row])]
        grid = view.variables["stable_states"].reshape(len(view.parameter_values[row]), -1)[
            np.isfinite(view.parameter_values[row])
        ]
        for place, known in zip(np.ndindex(grid.shape), grid.ravel(), strict=True):
            at = d.places(axes, view.variables["F"][place[1]], y[place[0]])[0]
            i, j = (int(np.clip(at[k] * n, 0, n - 1)) for k in (1, 0))
            d.marks += 1
            if _uniform(pixels, i, j) and not any(
                p.contains_point((view.variables["F"][place[1]], y[place[0]]))
                for c in covers
                for p in c.get_paths()
            ):
                word = table[int(pixels[i, j])]
                found.append(
                    (
                        f"pixel {i, j}",
                        ""
                        if word == STATE_WORDS[int(known)]
                        else f"{word} at {place} is {STATE_WORDS[int(known)]}",
                    )
                )
        return found
    for i, j in random.integers(0, n, (PLACES, 2)):
        if not _uniform(pixels, i, j):
            continue
        x, y = to_data.transform(((j + 0.5) / n, (i + 0.5) / n))
        rod = rods(x, y)
        true, word = class_of(rod), table[int(pixels[i, j])]
        if any(path.contains_point((x, y)) for cover in covers for path in cover.get_paths()):
            word = "crushed"
        d.marks += 1
        found.append((f"pixel {i, j}", "" if word == true else f"{word} at {x, y} is {true}"))
    return found


def _row_bars(d, axes, view, mesh, words, rods, row):
    """Classes along bars of rows, and the names of these."""
    found, values = [], view.parameter_values[row]
    for tick, label in zip(axes.get_yticks(), axes.get_yticklabels(), strict=True):
        text = plain(label.get_text()).partition(" = ")[2]
        found.append((label.get_text(), nearly(text, float(values[round(tick)]))))
    table = np.asarray(mesh.get_array()).reshape(len(values), -1)
    edges = mesh.get_coordinates()[0, :, 0]
    for i in range(len(values)):
        for j in np.linspace(BESIDE_EDGE, table.shape[1] - BESIDE_EDGE - 1, PLACES // 3).astype(int):
            part = table[i, j - BESIDE_EDGE : j + BESIDE_EDGE + 1]
            if (part == table[i, j]).all() and "stable_states" not in view.variables:
                x = (edges[j] + edges[j + 1]) / 2
                word, true = words.get(to_hex(mesh.to_rgba(table[i, j]))), class_of(rods(x, values[i]))
                d.marks += 1
                found.append((f"row {i}", "" if word == true else f"{word} at {x} is {true}"))
    return found


def _curves(d, axes, view, line, row, rods, states):
    """Boundaries, their names, folds, the partial beam, and the points where Re c = 0."""
    v, found = view.variables, []
    stored, count = int((v["crossing_kind"] > 0).sum()), int(v["crossing_count"].clip(min=0).sum())
    for text, match in read(d.page, r"curves through NUMBER of NUMBER crossings of the rows: raise"):
        found.append((text, "" if (int(match[1]), int(match[2])) == (stored, count) else f"{stored} {count}"))
    if "curve_number" not in v:
        return found
    thin = d.lines(axes, lambda one: one.get_marker() in ("None", "") and colour_of(one) == "#000000")
    crushing = [
        one
        for one in d.lines(axes, lambda one: one.get_marker() in ("None", "") and colour_of(one) == "#666666")
    ]
    for one in crushing:
        x, y = xy([one])
        found.append(("edge of crushing", d.compare(axes, (x, y), (x, x), LINE)))
    there = np.ones(len(v["curve_kind"]), bool) if not states else v["curve_kind"] == 1
    true = [v[f"curve_{name}"][there] for name in (line, row)]
    if "bautin_curve" in v:
        true = [np.append(part, v[f"bautin_{name}"]) for part, name in zip(true, (line, row), strict=True)]
    found.append(("curves", d.compare(axes, xy(thin), true)))
    for one in thin:
        found += [("chord of a curve", why) for why in _chords(d, axes, one, view, line, row, rods)]
    folds = d.lines(axes, lambda one: one.get_marker() == "o")
    of = (v["fold_kind"] == 1) & (v["fold_of"] == 1) & (not states)
    places = [v[f"fold_{name}"][of] for name in (line, row)]
    found.append(("folds", d.compare(axes, xy(folds), places)))
    for text, match in read(d.page, rf"^fold {line} = NUMBER, {row} = NUMBER$"):
        found.append((text, _told_place(view, "fold", match, (line, row), of)))
    for cross in d.lines(axes, lambda one: one.get_marker() == "+"):
        half = rs.Rod(k1=np.inf, k2=np.inf, gamma3=0.0).thresholds(F_max=60).F_hopf
        beam = {"F": 2 * half, "k1": 4 * half}
        found.append(("partial beam", d.compare(axes, xy([cross]), ([beam[line]], [beam[row]]), LINE)))
        for text, match in read(d.page, r"2Fc = NUMBER, 4Fc = NUMBER"):
            found.append((text, nearly(match[1], 2 * half) or nearly(match[2], 4 * half)))
    if "bautin_curve" in v:
        white = d.lines(axes, lambda one: one.get_marker() == "D" and one.get_markersize() == 5)
        found.append(("Re c = 0", d.compare(axes, xy(white), [v[f"bautin_{name}"] for name in (line, row)])))
        for text, match in read(d.page, rf"^generalised Hopf point: {line} = NUMBER, {row} = NUMBER$"):
            found.append((text, _told_place(view, "bautin", match, (line, row), slice(None))))
        read(d.page, r"^Re c = NUMBER: ")
    return found


def _told_place(view, what, match, names, of):
    """Why a place in the legend is none of the file's, or has more digits than its error leaves."""
    v = view.variables
    each = [(v[f"{what}_{n}"][of], v[f"{what}_{n}_error"][of]) for n in names]
    i = int(np.argmin(np.abs(each[0][0] - float(match[1]))))
    why = []
    for text, (values, errors) in zip(match.groups(), each, strict=True):
        off = abs(float(text) - values[i]) + errors[i]
        why.append("" if off <= unit_of(text) else f"{text} is {values[i]} +- {errors[i]}")
    return "; ".join(filter(None, why))


def _chords(d, axes, one, view, line, row, rods):
    """Why a curve leaves the true boundary half way between two of its points."""
    x, y = xy([one])
    at = d.places(axes, x, y)
    steps = np.linalg.norm(np.diff(at, axis=0), axis=1)
    double = ":" if "curve_criticality" in view.variables else "--"
    kinds = ("hopf", "hopf_reverse", "restabilization") if one.get_linestyle() != double else ()
    to_data = axes.transAxes + axes.transData.inverted()
    for i in np.argsort(steps)[::-1][:3]:
        middle = to_data.transform((at[i] + at[i + 1]) / 2)
        rod = rods(*middle)
        if 0.98 * rod.k1 <= rod.F:
            continue
        off = []
        for k, name in enumerate((line, row)):
            ends = [to_data.transform((at[i] + at[i + 1]) / 2 + s * np.eye(2)[k] * 0.03)[k] for s in (-1, 1)]
            low, high = max(ends[0], 0.0 if name in ("F", "gamma3") else 1e-9), ends[1]
            if name == "F":
                high = min(high, 0.999 * rod.k1)
            if name == "k1":
                low = max(low, 1.001 * rod.F)
            true = [
                c.value
                for c in changes_along(rod, name, float(low), float(high))
                if not kinds or c.kind.name in kinds
            ]
            places = [middle if j == k else middle for j in range(2)]
            for place in true:
                other = np.array(places[0])
                other[k] = place
                off.append(float(np.abs(d.places(axes, *other)[0] - (at[i] + at[i + 1]) / 2)[k]))
        d.marks += 1
        yield (
            ""
            if off and min(off) <= LINE
            else f"the boundary is {min(off, default=np.inf):.2g} beside {middle}"
        )


def _cycle_curves(d, axes, view, line, row):
    """Curves of folds and torus points of cycles, and special points on rows: on a curve or marked."""
    v, found = view.variables, []
    curves = d.lines(axes, lambda one: one.get_marker() in ("None", ""))
    if "cycle_curve_number" in v:
        found.append(
            ("curves of cycles", d.compare(axes, xy(curves), [v[f"cycle_curve_{n}"] for n in (line, row)]))
        )
    if "cycle_special_kind" in v:
        marks = d.lines(axes)
        kinds = v["cycle_special_kind"].reshape(v["status"].size, -1)
        at, values = v[f"cycle_special_{line}"].reshape(kinds.shape), view.point_columns[row]
        there = np.isin(kinds, list(SPECIAL.values())) & np.isfinite(values)[:, None]
        rows = np.broadcast_to(values[:, None], at.shape)
        true = at[there], rows[there]
        found.append(("special points of cycles", d.compare(axes, xy(marks), true, whole=False)))
        drawn = [d.places(axes, *xy([one])) for one in [*marks, *curves]]
        dense = [
            np.concatenate(
                [a + (b - a) * np.linspace(0, 1, 50)[:, None] for a, b in zip(p[:-1], p[1:], strict=True)]
                or [p]
            )
            for p in drawn
        ]
        places = d.places(axes, *true)
        if len(places):
            off = cKDTree(np.concatenate(dense)).query(places)[0] if dense else [1.0]
            found.append(
                (
                    "special points of cycles",
                    "" if max(off) < 5 * LINE else f"one is not drawn, off by {max(off)}",
                )
            )
    return found
