"""A figure of `rodsweep plot` whose texts and marks are read one by one and held against true ones.

A `Drawing` remembers which texts, numbers and marks were compared; what is left over was compared with
nothing. Places are compared in the panel, as fractions of its axes: what is stored must lie on its place,
what a solver gives anew within the width of a line.
"""

import functools
import re
from math import floor, log10

import numpy as np
from matplotlib.axis import Axis
from matplotlib.colors import to_hex
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.spines import Spine
from matplotlib.text import Annotation, Text
from scipy.spatial import cKDTree

from rodsweep.model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES
from rodsweep.model.rod import Rod
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum

from .arm_sentences import UNIT, UNITS_AND_EXAMPLES
from .page import NUMBER, Page, read
from .truths import changes_over_force

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
            if plain(axis.get_label_text()) == "Poisson's ratio":
                continue  # `second_scales` compares them with k2
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


@functools.cache
def roots_of(rod, modes):
    """The leading eigenvalues of a rod, (modes,)."""
    return np.array(solve_spectrum(rod, SpectrumRequest(max(modes, 2), 1e-11, True)).eigenvalues[:modes])


@functools.cache
def changes_to(rod, top):
    return tuple(changes_over_force(rod, top))


def unloaded(view):
    """The rods of a file at F = 0, and up to where these were searched."""
    columns, tops = view.point_columns, view.variables["F_end"].ravel()
    rods = [
        Rod(F=0.0, **dict(zip(NON_OPTIONAL_LINEAR_PARAMETER_NAMES[1:], map(float, row), strict=True)))
        for row in zip(*(columns[n] for n in NON_OPTIONAL_LINEAR_PARAMETER_NAMES[1:]), strict=True)
    ]
    return [(rod, float(top)) for rod, top in zip(rods, tops, strict=True)]


def rods_of_line(line, entries, columns):
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


CRITICAL = {"onset F*": "onset", "Hopf F**": "hopf", "restabilization": "restabilization"}


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


def class_of(rod):
    """What a straight rod does."""
    if rod is None:
        return "crushed"
    w = roots_of(rod, 2)[0]
    return "flutter" if w.real > 0 else "oscillatory decay" if w.imag else "monotone decay"


def words_of(view):
    return np.array([view.flags[int(s)] for s in view.variables["status"].ravel()])


def unit_factor(label):
    """The unit at the end of a label, in SI; 1 where it has none."""
    match = re.search(rf"\(({UNIT})\)$", label)
    return UNITS_AND_EXAMPLES[match[1]] if match else None


def first_forces(view):
    """The first force of each kind of every rod, nan without: {kind: (rods,)}."""
    every = [changes_to(rod, top) for rod, top in unloaded(view)]
    return {
        kind: np.array([next((c.value for c in each if c.kind.name == kind), np.nan) for each in every])
        for kind in CRITICAL.values()
    }
