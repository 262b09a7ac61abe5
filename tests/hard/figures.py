"""The figures that `rodsweep plot` draws of random sweeps, every text and every mark of them read.

A `Drawing` remembers which texts, numbers and marks were held against true ones; what is left over was
compared with nothing. Places are compared in the panel, as fractions of its axes: what is stored must lie on
its place, what a solver gives anew within the width of a line.
"""

import functools
import re
from dataclasses import replace
from math import floor, log10, pi
from pathlib import Path

import numpy as np
from matplotlib.axis import Axis
from matplotlib.collections import Collection, PathCollection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.contour import ContourSet
from matplotlib.image import AxesImage
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.quiver import Quiver
from matplotlib.spines import Spine
from matplotlib.text import Annotation, Text
from rods import rod_of
from scipy.spatial import cKDTree

import rodsweep as rs
from rodsweep.api.dataset import view_of
from rodsweep.discretization.periodic import resampled
from rodsweep.errors import InputError
from rodsweep.model.drag import DRAGS
from rodsweep.model.neglected import Validity
from rodsweep.model.parameters import LINEAR_PARAMETERS
from rodsweep.model.rod import Rod
from rodsweep.post.branch_curves import curves_of
from rodsweep.post.figures import draw
from rodsweep.post.figures.request import Look
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum

from .arm_sentences import NAMED, UNIT, UNITS, force_unit, in_si, quantities_at_points
from .page import NUMBER, Page, read, unit_of
from .sentences import FINE, random_sweep, solved
from .truths import changes_along, changes_on_lines, changes_over_force, leading, rods_of

SAME = 1e-6
"""Fraction of an axis within which a stored number is drawn at its place."""
LINE = 1e-3
"""Fraction of an axis within which a curve between stored numbers is that of the solver."""
OUTSIDE = 1e-6
"""Fraction of an axis by which rounding may put a mark outside of it."""
TEX = (
    (r"\\mathdefault|\\mathrm|\\tilde|\\!|[${}]", ""),
    (r"\\,|\n|\xa0|~", " "),
    (r"\\infty", "inf"),
    (r"\\times10\^(-?)(\d+)", lambda m: f"e{m[1] or '+'}{m[2]}"),
    (r"(?<![\d.])10\^(-?)(\d+)", lambda m: f"1.00000e{m[1] or '+'}{m[2]}"),
    (r"\\omega", "w"),
    (r"\\dagger", "+"),
    (r"\\(gamma|tau|Theta|Pi|sqrt|max|min|times|dot)", r"\1"),
    (r"(?<=\w)_(?=[\d*mc])", ""),
    ("\N{MINUS SIGN}", "-"),
    (r" +", " "),
)
"""How a text in TeX is read as plain text."""
PARAMETERS = {
    "follower force F": "F",
    "stretch stiffness k1": "k1",
    "shear stiffness k2": "k2",
    "rotational drag gamma3": "gamma3",
    "axial drag gamma1": "gamma1",
    "inverse rotational drag 1/gamma3": "1/gamma3",
}
"""What the label of an axis of a parameter says."""
PARAMETER = rf"(?<![\w^])(F|k1|k2|gamma1|gamma3) ?= ({NUMBER}|inf)(?![\w*])"


def plain(text):
    """A text as it is read aloud: `$\\tilde k_1 = 10^{4}$` is `k1 = 1.00000e+4`."""
    for pattern, by in TEX:
        text = re.sub(pattern, by, text)
    return text.strip()


def nearly(text, true, digits=6, slack=0.0):
    """Why a number with so many digits is not the true one, to half a unit of the last; slack: absolute."""
    if text == "inf" or np.isinf(true):
        return "" if float(text) == true else f"{text} is {true}"
    unit = 10.0 ** (floor(log10(abs(true))) - digits + 1) if true else 0.0
    off = abs(float(text) - true)
    return "" if off <= 0.5 * unit * (1 + 1e-6) + slack else f"{text} is {float(true)!r}"


def one_of(text, values, digits=6):
    """Why a number is none of several."""
    values = np.ravel(values)
    return nearly(
        text, float(min(values, key=lambda x: 0 if x == float(text) else abs(x - float(text)))), digits
    )


class Drawing:
    """A figure, and what of it was read: texts and their numbers in `page`, marks in `left` until taken."""

    def __init__(self, figure, sentence):
        figure.draw_without_rendering()
        self.figure, self.sentence, self.marks, self.tick_labels = figure, sentence, 0, 0
        self.panels = [axes for axes in figure.axes if not hasattr(axes, "_colorbar")]
        self.left = {}
        for axes in self.panels:
            for artist in axes.get_children():
                if self._is_mark(artist) and artist is not axes.patch:
                    self.left[artist] = axes
        self.page = Page("\n".join(["", plain(sentence.partition(": ")[2]), *map(plain, self._texts())]))

    @staticmethod
    def _is_mark(artist):
        if isinstance(artist, Line2D):
            x, y = (np.asarray(values, float) for values in artist.get_data())
            return bool((np.isfinite(x) & np.isfinite(y)).any())
        if isinstance(artist, Text) and not isinstance(artist, Annotation):
            return False
        return not isinstance(artist, Spine | Axis | Legend) and not hasattr(artist, "set_functions")

    def every_axes(self):
        """All panels, bars of colours and second scales."""
        return [*self.figure.axes, *(child for axes in self.figure.axes for child in axes.child_axes)]

    def legend_entries(self, axes=None):
        """(handle, text) of all legends, or of that of a panel."""
        legends = self.figure.legends if axes is None else [axes.get_legend()] * bool(axes.get_legend())
        return [
            (handle, plain(text.get_text()))
            for legend in legends
            for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True)
        ]

    def _texts(self):
        yield from (text.get_text() for text in self.figure.texts)
        for legend in [*self.figure.legends, *(a.get_legend() for a in self.figure.axes if a.get_legend())]:
            yield from (text.get_text() for text in legend.get_texts())
        for axes in self.every_axes():
            texts = [child for child in axes.get_children() if isinstance(child, Text)]
            yield from (text.get_text() for text in [*texts, axes.xaxis.label, axes.yaxis.label])

    def title(self, axes):
        """What stands above a panel and above the whole figure."""
        texts = [axes.get_title(loc) for loc in ("left", "center", "right")]
        return plain(" ".join([*texts, *(text.get_text() for text in self.figure.texts)]))

    def label(self, axes, which):
        """The label of an axis of a panel, or of one that is shared with it."""
        shared = axes.get_shared_x_axes() if which == "x" else axes.get_shared_y_axes()
        labels = (getattr(each, f"get_{which}label")() for each in (axes, *shared.get_siblings(axes)))
        return plain(next(filter(None, labels), ""))

    def take(self, axes, kind, test=lambda artist: True):
        """The marks of a kind in a panel that were not read yet; now they are."""
        found = [
            mark for mark, of in self.left.items() if of is axes and isinstance(mark, kind) and test(mark)
        ]
        for mark in found:
            del self.left[mark]
        return found

    def lines(self, axes, test=lambda line: True):
        """Lines and markers at places of both axes."""
        return self.take(axes, Line2D, lambda one: one.get_transform() == axes.transData and test(one))

    def zeros(self, axes):
        """Takes the lines of zero."""
        for way in (0, 1):
            self.take(
                axes,
                Line2D,
                lambda one, way=way: (
                    one.get_transform() != axes.transData and not np.any(one.get_data()[way])
                ),
            )

    def verticals(self, axes):
        """(place, line) of lines across a panel."""
        found = self.take(
            axes,
            Line2D,
            lambda one: one.get_transform() == axes.get_xaxis_transform() and len(set(one.get_xdata())) == 1,
        )
        self.marks += len(found)
        return [(float(line.get_xdata()[0]), line) for line in found]

    def places(self, axes, x, y):
        """Places as fractions of the axes, (n, 2); without those of no number."""
        x, y = np.broadcast_arrays(np.ravel(np.asarray(x, float)), np.ravel(np.asarray(y, float)))
        there = np.isfinite(x) & np.isfinite(y)
        at = axes.transData.transform(np.column_stack([x[there], y[there]]))
        return axes.transAxes.inverted().transform(at)

    def compare(self, axes, drawn, true, within=SAME, whole=True):
        """Why places that are drawn, (x, y), are none of the true ones; whole: each of these is drawn too."""
        drawn, true = self.places(axes, *drawn), self.places(axes, *true)
        self.marks += len(drawn)
        why = []
        if drawn.size and (abs(drawn - 0.5) > 0.5 + OUTSIDE).any():
            why.append(f"{(abs(drawn - 0.5) > 0.5 + OUTSIDE).any(axis=1).sum()} places are outside the axes")
        for some, others, words in ((drawn, true, "drawn and not true"), (true, drawn, "true and not drawn"))[
            : 1 + whole
        ]:
            off = cKDTree(others).query(some)[0] if len(others) and len(some) else np.full(len(some), np.inf)
            if len(some) and not off.max() <= within:
                why.append(f"{(~(off <= within)).sum()} places are {words}, off by {off.max():.2g}")
        return "; ".join(why)

    def unread(self):
        """(what, why) of texts, numbers and marks that nothing has read."""
        found = [(line, f"nothing reads {', '.join(numbers)}") for line, numbers in self.page.unread()]
        kinds = [f"{type(mark).__name__} {getattr(mark, 'get_label', str)()}" for mark in self.left]
        return found + [(kind, "nothing reads the mark") for kind in kinds]

    def count(self):
        """(texts, numbers in texts and at ticks, marks) that were read."""
        return len(self.page), sum(map(len, self.page.seen.values())) + self.tick_labels, self.marks


def xy(lines):
    """The vertices of lines, one after another: (x, y)."""
    if not lines:
        return np.zeros(0), np.zeros(0)
    return tuple(np.concatenate([np.asarray(line.get_data()[k], float) for line in lines]) for k in (0, 1))


def colour_of(mark):
    """The colour of a line, its edge's where it is a marker, or of what a patch is filled with."""
    if isinstance(mark, Line2D):
        return to_hex(mark.get_color())
    return to_hex(np.ravel(mark.get_facecolor())[:4])


def told(text):
    """The parameters that a text states, as text."""
    return dict(re.findall(PARAMETER, text))


def chosen(columns, given, digits=6):
    """Which points, a mask, have the parameters that a text states."""
    there = np.ones(len(next(iter(columns.values()))), bool)
    for name, text in given.items():
        if name in columns:
            there &= np.array([not nearly(text, float(x), digits) for x in columns[name]])
    return there


def ticks(d):
    """The check of the numbers at the ticks of all axes."""
    found = []
    for axes in d.every_axes():
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            text = plain(axis.get_offset_text().get_text()) if axis.get_offset_text().get_visible() else ""
            factor = re.search(r"1(?:\.0*)?e([+-]?\d+)", text)
            factor = 10.0 ** int(factor[1]) if factor else 1.0
            for place, label in zip(axis.get_majorticklocs(), axis.get_majorticklabels(), strict=False):
                said = plain(label.get_text())
                within = low - SAME * (high - low) <= place <= high + SAME * (high - low)
                if not (within and said and label.get_visible() and axis.get_visible()):
                    continue
                d.tick_labels += 1
                if re.fullmatch(NUMBER, said) is None:
                    continue  # of rods and points by name, which their figures read
                digits = len(re.sub(r"e.*|[-.]", "", said).lstrip("0")) or 1
                if nearly(said, place / factor, digits, 1e-9 * (high - low) / factor) or (
                    "+" in text and "e" not in text
                ):
                    found.append((f"tick {said} {text}", f"it is at {place}"))
    return found


def parameters_told(d, columns, digits=6):
    """The check of parameters in texts that nothing else has read: values of the points."""
    found = []
    for line in d.page:
        left = dict(d.page.unread()).get(line, [])
        if not left:
            continue
        for match in re.finditer(PARAMETER, line):
            if match[1] in columns and (match[2] in left or match[2] == "inf"):
                found.append((line, one_of(match[2], columns[match[1]], digits)))
                d.page.mark(line, match.span(2))
    return found


def reads(d, pattern, check):
    """The check of every text with a pattern: check says of a match why it is wrong."""
    return [(line, check(match)) for line, match in read(d.page, pattern)]


# --- spectra and modes ---------------------------------------------------------------------------------


@functools.cache
def roots_of(rod, modes):
    """The leading eigenvalues of a rod, (modes,)."""
    return np.array(solve_spectrum(rod, SpectrumRequest(max(modes, 2), 1e-11, True)).eigenvalues[:modes])


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
        counts = [np.isfinite(line.get_ydata()).sum() for line in of]
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
    for at, line in d.verticals(axes):
        word, _, number = plain(line.get_label()).partition(" = ")
        kind = {"F*": "onset", "F**": "hopf", "restabilization": "restabilization"}[word.strip()]
        near = min((c.at for c in true if c.kind.name == kind), key=lambda c: abs(c - at), default=np.inf)
        yield d.compare(axes, ([at], [0.0]), ([near], [0.0]), LINE) if near < np.inf else f"no {kind} at {at}"
        yield nearly(number, near)
        texts = [
            text for text in d.page if text in plain(line.get_label()) or f"{word.strip()} = {number}" in text
        ]
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
            edges = np.concatenate([[c.at for c in true], x])
            yield d.compare(axes, ([left, right], [0, 0]), (edges, np.zeros(len(edges))), LINE, whole=False)
    wrong = (inside != (growth > 0)) & np.isfinite(growth) & (growth != 0)
    yield f"shade and growth differ at {x[wrong]}" if wrong.any() else ""


def _growth_map(d, axes, names, columns, growth):
    """Levels of the growth rate over two parameters, and its line of zero."""
    levels, *zero = sorted(d.take(axes, ContourSet), key=lambda each: -len(each.levels))
    x, y = (columns[name] for name in names)
    d.marks += len(x)
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


# --- thresholds and normal forms -------------------------------------------------------------------------

ALIKE = 0.01
"""Fraction of an axis within which several rods have one line, if the legend says so."""
CRITICAL = {"onset F*": "onset", "Hopf F**": "hopf", "restabilization": "restabilization"}
COLOURS_OF_FORCES = {"#0072b2": "onset", "#d55e00": "hopf", "#009e73": "restabilization"}
MARKERS_OF_FORCES = {"o": "onset", "s": "hopf", "^": "restabilization"}


@functools.cache
def changes_to(rod, top):
    return tuple(changes_over_force(rod, top))


def unloaded(view):
    """The rods of a file at F = 0, and up to where these were searched."""
    columns, tops = view.point_columns, view.variables["F_end"].ravel()
    rods = [
        rod_of(0.0, *map(float, row))
        for row in zip(*(columns[n] for n in LINEAR_PARAMETERS[1:]), strict=True)
    ]
    return [(rod, float(top)) for rod, top in zip(rods, tops, strict=True)]


def first_forces(view):
    """The first force of each kind of every rod, nan without: {kind: (rods,)}."""
    every = [changes_to(rod, top) for rod, top in unloaded(view)]
    return {
        kind: np.array([next((c.at for c in each if c.kind.name == kind), np.nan) for each in every])
        for kind in CRITICAL.values()
    }


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
            here = _rods_of_line(line, entries, columns)
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
    return searched + found + parameters_told(d, columns) + parameters_told(d, columns, 3)


def _rods_of_line(line, entries, columns):
    """Which rods a line goes through, by what the legend says of its look."""
    here = np.ones(len(columns["k1"]), bool)
    for handle, text in entries:
        if not isinstance(handle, Line2D) or not told(text):
            continue
        grey = colour_of(handle) == to_hex("0.3")
        same = (
            handle.get_linestyle() == line.get_linestyle() if grey else colour_of(handle) == colour_of(line)
        )
        if same:
            (name,) = told(text)
            values = re.findall(rf"{NUMBER}|inf", text.partition("=")[2])
            here &= [any(not nearly(value, float(x), 3) for value in values) for x in columns[name]]
    return here


def cells(d, axes, mesh, at, values):
    """Why cells of a map have other numbers than their points, which lie in the middle of cells."""
    shown = np.ma.filled(np.ma.asarray(mesh.get_array(), float), np.nan)
    there = np.isfinite(at[0]) & np.isfinite(at[1])
    near, why = cell_of(d, axes, mesh, at)
    shown, values = shown.ravel()[near], np.asarray(values, float)[there]
    if why:
        return why
    if not (np.isnan(shown) == np.isnan(values)).all():
        return f"{(np.isnan(shown) != np.isnan(values)).sum()} cells are empty or not"
    wrong = ~np.isclose(shown, values, rtol=1e-6, atol=0) & np.isfinite(values)
    if wrong.any():
        return f"{shown[wrong]} is {values[wrong]}"
    low, high = mesh.get_clim()
    known = values[np.isfinite(values)]
    one = known.min() == known.max() and 0 <= low <= known[0] <= high
    right = one or np.allclose([low, high], [known.min(), known.max()], rtol=1e-6)
    return "" if right else f"colours end at {low, high}"


def cell_of(d, axes, mesh, at):
    """(cell of every point, why cells do not part where two neighbours are equally far)."""
    grid, places = mesh.get_coordinates(), d.places(axes, *at)
    corners = d.places(axes, grid[..., 0], grid[..., 1]).reshape(grid.shape)
    d.marks += len(places)
    cell, why = np.zeros(len(places), int), ""
    for k, edges in enumerate((corners[0, :, 0], corners[:, 0, 1])):
        values = np.unique(places[:, k].round(9))
        inner = (values[1:] + values[:-1]) / 2
        if len(values) != len(edges) - 1 or not np.allclose(edges[1:-1], inner, atol=SAME):
            why = f"cells part at {edges} between {values}"
        step = 1 if k == 0 else len(corners[0]) - 1
        cell += step * np.clip(np.searchsorted(edges, places[:, k]) - 1, 0, len(edges) - 2)
    return cell, why or ("" if len(set(cell)) == len(cell) else "points share a cell")


CLASSES = {"monotone", "oscillatory", "flutter", "undecided", "crushed"}


def class_of(rod):
    """What a straight rod does."""
    if rod.k1 <= rod.F:
        return "crushed"
    w = roots_of(rod, 2)[0]
    return "flutter" if w.real > 0 else "oscillatory" if w.imag else "monotone"


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
        edges = np.array([0.0, top, *(c.at for c in changes_to(rod, top))])
        off = max(np.abs(edges - at).min() for at in (start, end)) / top
        found.append((f"bar {start} to {end}", "" if off <= SAME else f"an end is off by {off}"))
        word = words.get(colour_of(bar))
        true = class_of(replace(rod, F=(start + end) / 2))
        found.append((f"bar {start} to {end}", "" if word in (true, "undecided") else f"{word} is {true}"))
    found.append(("bars", "" if np.allclose(covered, [top for _, top in rods]) else f"bars end at {covered}"))
    for line in d.lines(axes):
        word = plain(line.get_label()).partition(" = ")[0]
        places = []
        for i, (rod, top) in enumerate(rods):
            for c in changes_to(rod, top):
                kind = c.kind.name if c.kind.name != "hopf" or c.unstable_after <= 2 else "further Hopf point"
                if kind == CRITICAL.get(word, word.removesuffix("s")):
                    places.append((i + 1, c.at) if upright else (c.at, i))
        found.append((word, d.compare(axes, xy([line]), np.array(places).reshape(-1, 2).T)))
        for text, match in [] if upright else read(d.page, rf"^{re.escape(word)} = (.*)$"):
            numbers = match[1].split(", ")
            true = [place[0] for place in places]
            why = "" if len(numbers) == len(true) else f"it is {true}"
            found.append((text, why or "; ".join(filter(None, map(nearly, numbers, true)))))
    return found + parameters_told(d, view.point_columns)


SIDES = {"supercritical": -1, "subcritical": 1, "undecided": 0}


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
        "supercritical, a later one subcritical"
        if side == -1 and more
        else {-1: "supercritical", 1: "subcritical", 0: "undecided"}.get(
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


# --- limit cycles ----------------------------------------------------------------------------------------


def words_of(view):
    return np.array([view.flags[int(s)] for s in view.variables["status"].ravel()])


def unit_factor(label):
    """The unit at the end of a label, in SI; 1 where it has none."""
    match = re.search(rf"\(({UNIT})\)$", label)
    return UNITS[match[1]] if match else None


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
            hopf["F**" if c.kind.name == "hopf" else "restabilization"].append(c.at)
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
        right = sorted(float(one.get_xdata()[0]) for one in lost) == sorted(gone.tolist())
        found.append((label, "" if right else f"{len(lost)} marks at the top for {len(gone)} points"))
        open_ = d.lines(
            axes, lambda one: to_hex(one.get_markerfacecolor()) == "#ffffff" and one.get_marker() != "None"
        )
        unstable = words == "unstable"
        found.append((label, d.compare(axes, xy(open_), (columns[x][unstable], values[unstable]))))
        laws = d.lines(axes, lambda one: one.get_marker() == "None")
        for line in laws:
            found.append((label, _law(d, axes, line, view, fine, every)))
        for line in d.lines(axes):
            here = _rods_of_line(line, d.legend_entries(), columns) & np.isfinite(values)
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
        scale = in_si(view)["length"][i] / UNITS[view.typed.get("length", "m")] if view.quantities else 1.0
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
        rod = Rod(**{n: (shared | {y: float(value)})[n] for n in LINEAR_PARAMETERS})
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
            unit = 1.0 if match[2] == "tau2" else cycle.scale("tau2") / UNITS[match[2]]
            found.append((line, cycle.number(match[1], "period", unit, 4 if unit != 1 else 6)))
        for _, match in read(d.page, r"(?:^|[^T]) = NUMBER tau1", only=line):
            tau1 = cycle.columns["gamma3"] / cycle.columns["k2"]
            found.append((line, cycle.number(match[1], "period", 1 / tau1)))
        for _, match in read(d.page, rf"mean power NUMBER(?: ({UNIT}))?", only=line):
            power = cycle.scale("force_scale") * cycle.scale("length") / cycle.scale("tau2")
            found.append(
                (line, cycle.number(match[1], "injection_mean", power / UNITS[match[2]] if match[2] else 1.0))
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
            true = resampled(self.fine["injection"] - self.fine["dissipation"], phase)
            error = self.error("injection")
        else:
            name = names[kind] if names[kind] in self.fine else names[kind].replace("tip", "shape")
            samples = self.fine[name] if self.fine[name].ndim == 1 else self.fine[name][:, -1]
            true, error = resampled(samples, phase), self.error(name)
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
        path = [resampled(values, phase) for values in tips]
        return [*found, ("path of the tip", d.compare(axes, xy(d.lines(axes)), path))]


# --- phase diagrams --------------------------------------------------------------------------------------

STATE_WORDS = {
    1: "straight rod stable",
    2: "cycle stable",
    3: "both stable",
    0: "no stable state known",
    4: "undecided",
    5: "crushed",
    -1: "missing",
}
BESIDE_EDGE = 5
"""Pixels from another class within which no pixel is compared."""
PLACES = 60
"""Places of a map whose class is computed."""
SPECIAL = {"folds of cycles on rows": 2, "torus points on rows": 3, "symmetry breakings": 4}


def diagram_figure(d, view, _):
    v, columns, found = view.variables, view.point_columns, []
    (axes,) = d.panels
    line = next(name for name in LINEAR_PARAMETERS if name not in view.parameters)
    row = next((name for name in view.parameters if len(view.axes[name]) > 1), view.parameters[0])
    fixed = {
        name: float(view.axes[name][0])
        for name in view.parameters
        if name in LINEAR_PARAMETERS and name != row
    }

    def rods(x, y):
        return Rod(**(fixed | {line: float(x), row: float(y)}))

    words = {colour_of(h): text for h, text in d.legend_entries() if isinstance(h, Patch)}
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
        y = view.axes[row][np.isfinite(view.axes[row])]
        grid = view.variables["stable_states"].reshape(len(view.axes[row]), -1)[np.isfinite(view.axes[row])]
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
    found, values = [], view.axes[row]
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
    for note in d.take(axes, Annotation):
        found.append((plain(note.get_text()), _at_named(plain(note.get_text()), rods(*note.xy))))
        read(d.page, r"^F\*\*? = NUMBER$")
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
    of = (v["fold_kind"] == 1) & (v["fold_of"] == 1)
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
        for text, match in read(d.page, rf"^Re c = 0: {line} = NUMBER, {row} = NUMBER$"):
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


def _at_named(name, rod):
    """Why a boundary has another name: at F** the leading mode is on the axis, at F* it is double."""
    w = roots_of(rod, 4)
    if name.startswith("F**"):
        return "" if abs(w[0].real) < 1e-3 * abs(w[0]) else f"eigenvalues are {w}"
    return "" if abs(w[0] - w[1]) < 3e-2 * abs(w[0]) else f"eigenvalues are {w}"


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
                c.at
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


# --- branches --------------------------------------------------------------------------------------------

BRANCH_WORDS = {
    "Hopf point": "hopf",
    "fold": "fold",
    "torus point": "torus",
    "symmetry breaking": "symmetry_breaking",
    "period doubling": "period_doubling",
    "the model ends (h1 = 0)": "left_the_model",
    "no further cycle found": "no_cycle_found",
    "last cycle stored": "list_full",
}
STYLE_OF_STABILITY = {"-": 1, "--": 0, ":": -1}


def branch_figure(d, view, fine):
    columns, found = view.point_columns, []
    entries = d.legend_entries()
    own = {rod: curves_of(view, rod) for rod in range(view.variables["status"].size)}
    true = {rod: curves_of(fine(), rod) for rod in own}
    upper, lower, *third = d.panels
    rods = [rod for rod in own if any(curve.cycles.any() for curve in own[rod])]
    colours = {colour_of(handle): told(text) for handle, text in entries if told(text)}
    straight = upper and d.lines(
        upper, lambda one: colour_of(one) == "#000000" and one.get_marker() == "None"
    )
    found += [("straight rod", _straight(d, upper, line, view, rods[0])) for line in straight]
    for axes, name in ((upper, "y"), (lower, "period")):
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
                    for s in curve.special
                    if BRANCH_WORDS[text] in (s.kind, s.reason)
                ]
                values = [s.tip_y_max if name == "y" else s.period for s in of_kind]
                found.append((text, d.compare(axes, xy(marks), ([s.at for s in of_kind], values))))
        every = d.lines(axes)
        found.append((name, _smooth(d, axes, every, [c for rod in rods for c in true[rod]], name)))
        stored = [c for rod in rods for c in own[rod]]
        xs, ys = (np.concatenate([getattr(c, n) for c in stored]) for n in ("at", name))
        found.append((name, d.compare(axes, (xs, ys), xy(every), 1e-4, whole=False)))
        found += [(name, _stable(d, line, own, rods, colours, columns, view)) for line in every]
    for axes in third:
        law = d.lines(axes, lambda one: one.get_label() == "by the normal form")
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
    for special, order in ((curve.special[0], 1), (curve.special[-1], -1)):
        a, at, y = special.amplitude_coefficient, curve.at[::order], curve.y[::order]
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
    name = next(n for n in LINEAR_PARAMETERS if f"branch_{n}" in view.variables)
    d.marks += 1
    for share in (0.001, 0.5, 0.999):
        values = {n: float(columns[n][rod]) for n in LINEAR_PARAMETERS if n in columns} | {
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
        steps = np.linspace(0, 1, 20, endpoint=False)[:, None]
        drawn += [a + (b - a) * steps for a, b in zip(at[:-1], at[1:], strict=True)] + [at[-1:]]
    tree = cKDTree(np.concatenate(drawn))
    worst, where = 0.0, None
    for curve in curves:
        some = curve.cycles
        places = d.places(axes, curve.at[some], getattr(curve, name)[some])
        inside = (np.abs(places - 0.5) <= 0.5).all(axis=1)
        off = tree.query(places)[0]
        if len(off) and (off * inside).max() > worst:
            worst, where = (off * inside).max(), float(curve.at[some][np.argmax(off * inside)])
    return "" if worst <= LINE else f"a cycle at {where} lies {worst:.2g} beside the curve"


def _stable(d, line, own, rods, colours, columns, view):
    """Why a piece of a branch has the line of another stability than the stored cycles along it."""
    x, y = xy([line])
    d.marks += 1
    of = colours.get(colour_of(line))
    here = chosen(columns, of) if of else np.ones(len(columns["k1"]), bool)
    said = STYLE_OF_STABILITY[line.get_linestyle()]
    for rod in rods:
        for curve in own[rod] if here[rod] else ():
            for i in np.flatnonzero(curve.cycles):
                on = np.hypot(x - curve.at[i], y - curve.y[i])[1:-1]
                if len(on) and on.min() == 0:
                    beside = set(curve.stable[max(i - 1, 0) : i + 1].tolist())
                    if said not in beside:
                        return f"stability at {curve.at[i]} is {beside}, not {said}"
    return ""


# --- arms over their own quantities ----------------------------------------------------------------------

ARM_LABELS = {"Young's modulus": "young", "Poisson's ratio": "poisson"}
STATUS_COVERS = {
    "shorter than 10 radii": "not_slender",
    "crushed": "crushed",
    "no flutter": "no_flutter",
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
    return {"": w.real / scales["tau2"] if label.startswith("growth") else np.abs(w.imag) * hertz}


def _drawn_arms(d, gridded, view):
    """(which points are drawn, which the band is of): the first along axes that the figure has not."""
    shape, on_axes = view.variables["status"].shape, set()
    for axes in d.panels:
        for which in "xy":
            name = re.sub(r" ?\([^)]*\)$", "", d.label(axes, which))
            name = ARM_LABELS.get(name, PARAMETERS.get(d.label(axes, which), name.replace(" ", "_")))
            on_axes |= {name} & set(gridded.over)
    sizes = [len(gridded.variables[name]) for name in gridded.over]
    at = np.indices(sizes).reshape(len(sizes), -1)
    here, band = np.ones(at.shape[1], bool), np.ones(at.shape[1], bool)
    for name, places in zip(gridded.over, at, strict=True):
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
    for line, match in read(d.page, r"drag ([a-z ]+?)(?: \(of NUMBER values\))?(?=,|$)"):
        names = {DRAGS[int(q["drag"])].replace("_", " ") for q in each if "drag" in q}
        found.append((line, "" if match[1] in names else f"drags {names}"))
    for line, match in read(
        d.page,
        rf"(?:^|, |(?<=\D) )([A-Za-z' ]+?) NUMBER(?: ({UNIT}|g/cm\^3|kg/m\^3))?"
        r"(?: \(of NUMBER values\))?(?=,| |$)",
    ):
        name = NAMED.get(match[1], match[1].strip().replace(" ", "_"))
        if name in each[0]:
            values = np.unique([q[name] for q in each]) / UNITS.get(match[3], 1.0)
            why = one_of(match[2], values, 4)
            found.append(
                (line, why if not match[4] or int(match[4]) == len(values) else f"{len(values)} values")
            )
    return found


# --- all figures -----------------------------------------------------------------------------------------


def second_scales(d, view):
    """The check of scales opposite to an axis: pressures of forces, times in tau1."""
    found = []
    for axes in d.figure.axes:
        for second in axes.child_axes:
            which = "x" if second.get_xlabel() else "y"
            label = plain(getattr(second, f"get_{which}label")())
            first = np.array(getattr(axes, f"get_{which}lim")())
            shown = np.array(getattr(second, f"get_{which}lim")())
            if not label:
                continue
            if label.endswith("tau1"):
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
    for line, match in read(d.page, r"the model does not apply(?: at NUMBER of NUMBER points)?"):
        outside = np.ravel(view.variables["model_applies"]) == Validity.does_not_apply
        numbers = [int(text) for text in match.groups() if text]
        right = numbers == [outside.sum(), outside.size] if numbers else outside.any()
        found.append((line, "" if right else f"it is {outside.sum()} of {outside.size}"))
    if any("hatched: the model does not apply" in line for line in d.page):
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
WIDTHS = (None, "89 mm", "183 mm")


def random_figure(index):
    """(task, keywords of `rs.sweep`, choices and the width of `rodsweep plot`) of that number."""
    random = np.random.default_rng([36, index])
    task, keywords = random_sweep(index)
    choices, width = {}, WIDTHS[int(random.integers(3))]
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
    keywords["F"] = np.linspace(0, min(top, 0.9 * keywords["k1"]), int(random.integers(6, 30))).tolist()
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
    return keywords, {"what": kind} if kind != "amplitude" else {}


_CHANGES = {"spectrum": _spectra, "thresholds": _forces, "criticality": _sides, "limit_cycle": _cycles}


def wrong_figure(task, keywords, choices, width):
    """(texts and marks that are wrong or that nothing reads, with why; counts, None without a figure)."""
    view = view_of(rs.sweep(task, progress=False, **keywords), Path(f"{task}.h5"))
    choices = {name: str(value) for name, value in choices.items() if value is not None}
    figures = []
    try:
        sentence = draw(view, Path("drawn.png"), look=Look(width=width), keep=figures.append, **choices)
    except InputError as refused:
        return (
            []
            if "that could be drawn" in str(refused) or "which needs" in str(refused)
            else [("refused", str(refused))]
        ), None
    d, listed = Drawing(figures[0], sentence), view.listed
    fine = functools.cache(lambda: solved(task, keywords | {"accuracy": FINE[task]}))
    of_arms = view.over and not choices and task in ("thresholds", "spectrum", "modes", "limit_cycle")
    found = arm_figure(d, view, listed, fine) if of_arms else CHECKS[task](d, listed, fine)
    found += quantities_told(d, listed) + second_scales(d, listed) + validity_told(d, listed) + ticks(d)
    found += [("in the sentence", "") for _ in read(d.page, r"of NUMBER points? (?:NUMBER|are|failed)")]
    return [(what, why) for what, why in found if why] + d.unread(), d.count()
