"""SVG element of a matplotlib figure for an HTML page, with texts under the pointer and colours for dark
pages."""

import re
from dataclasses import dataclass
from io import BytesIO
from xml.etree import ElementTree

import matplotlib
from matplotlib.figure import Figure

from .hover_points import hover_points

SVG = "http://www.w3.org/2000/svg"
XLINK = "http://www.w3.org/1999/xlink"
HEX_COLOUR_PATTERN = re.compile(r"#([0-9a-f]{6})(?![0-9a-f])")
"""Pattern for a colour in SVG: "#" and six hexadecimal digits."""
HOVER_RADIUS = "4"
"""Radius, in points, of the invisible circle around a value. The browser shows the title of the circle under
the pointer."""

ElementTree.register_namespace("", SVG)
ElementTree.register_namespace("xlink", XLINK)


@dataclass(frozen=True, slots=True)
class VectorPicture:
    """Figure as an SVG element of an HTML page. svg: text of the element.

    colours: colours of the picture, as six hexadecimal digits, which a dark page replaces. Empty for a
    picture that contains a bitmap, because the colours of a bitmap cannot be replaced; a dark page inverts
    the lightness of the whole picture instead.
    """

    svg: str
    colours: frozenset[str]
    width: float
    """Natural width of the picture, in points."""


def vector_picture(figure: Figure, number: int, caption: str) -> VectorPicture:
    """The figure as an SVG element. number: number of the picture on the page. caption: description for
    readers who cannot see the picture."""
    written = BytesIO()
    # Pictures of a page must not share the names of their clipping paths.
    with matplotlib.rc_context({"svg.hashsalt": f"picture {number}", "svg.fonttype": "path"}):
        figure.savefig(written, format="svg", transparent=False, metadata={"Date": None})
    root = ElementTree.fromstring(written.getvalue())
    for element_path in ("metadata", "defs/style"):
        _remove_element(root, element_path)
    colours = frozenset[str]()
    has_image = next(root.iter(f"{{{SVG}}}image"), None) is not None
    if not has_image:
        colours = _replace_colours_by_variables(root)
        root.set("fill", "var(--c000000, #000000)")
    root.attrib.pop("height", None)
    width = float(root.attrib.pop("width").removesuffix("pt"))
    root.set("role", "img")
    root.set("aria-label", caption)
    _add_hover_texts(root, figure)
    return VectorPicture(ElementTree.tostring(root, encoding="unicode"), colours, width)


def _remove_element(root: ElementTree.Element, element_path: str) -> None:
    """Removes the first element at a path below `root`. element_path: path of element names, such as
    "defs/style"."""
    *parents, name = element_path.split("/")
    parent = root.find("/".join(f"{{{SVG}}}{tag}" for tag in parents)) if parents else root
    if parent is not None and (found := parent.find(f"{{{SVG}}}{name}")) is not None:
        parent.remove(found)


def _replace_colours_by_variables(root: ElementTree.Element) -> frozenset[str]:
    """Replaces the colours of all elements by CSS variables; returns the colours."""
    colours = {"000000"}
    for element in root.iter():
        for attribute in ("style", "fill", "stroke"):
            if text := element.get(attribute):
                colours |= set(HEX_COLOUR_PATTERN.findall(text))
                element.set(attribute, HEX_COLOUR_PATTERN.sub(r"var(--c\1, \g<0>)", text))
    return frozenset(colours)


def _add_hover_texts(root: ElementTree.Element, figure: Figure) -> None:
    """Adds to the SVG element `root` an invisible circle for each value of the figure; the title of the
    circle is the text under the pointer."""
    group = ElementTree.SubElement(root, f"{{{SVG}}}g", {"class": "values"})
    for point in hover_points(figure):
        circle_attributes = {"cx": f"{point.x:.1f}", "cy": f"{point.y:.1f}", "r": HOVER_RADIUS}
        circle = ElementTree.SubElement(group, f"{{{SVG}}}circle", circle_attributes)
        ElementTree.SubElement(circle, f"{{{SVG}}}title").text = point.text


INK_BRIGHTNESS = 232
"""Brightness, from 0 to 255, of the grey that replaces black on the dark page."""
PAPER_BRIGHTNESS = 27
"""Brightness, from 0 to 255, of the grey that replaces white on the dark page, equal to the background."""
MIN_CONTRAST = 4.5
"""Smallest contrast ratio of a colour with the dark page. WCAG 2 requires 4.5 for text and 3 for graphics;
thin lines get the ratio for text."""
LIGHTENING_STEP_COUNT = 20
"""Number of steps between a colour and white that are tried when the colour is lightened."""


def dark_page_colour(colour: str) -> str:
    """Colour that replaces `colour` on the dark page. Colours are texts of six hexadecimal digits."""
    rgb = [int(colour[start : start + 2], 16) for start in (0, 2, 4)]
    if len(set(rgb)) == 1:
        rgb = [round(INK_BRIGHTNESS + (PAPER_BRIGHTNESS - INK_BRIGHTNESS) * value / 255) for value in rgb]
    else:
        fractions = (step / LIGHTENING_STEP_COUNT for step in range(LIGHTENING_STEP_COUNT + 1))
        lighter = ([value + (255 - value) * fraction for value in rgb] for fraction in fractions)
        rgb = [
            round(value)
            for value in next(
                candidate for candidate in lighter if _contrast_with_dark_page(candidate) >= MIN_CONTRAST
            )
        ]
    return "".join(f"{value:02x}" for value in rgb)


def _contrast_with_dark_page(channels: list[float]) -> float:
    """Contrast ratio, as defined by WCAG 2, of a colour with the background of the dark page. channels: red,
    green and blue, from 0 to 255."""
    return (_luminance(channels) + 0.05) / (_luminance([PAPER_BRIGHTNESS] * 3) + 0.05)


def _luminance(channels: list[float]) -> float:
    """Relative luminance, from 0 to 1, as defined by WCAG 2. channels: red, green and blue, from 0 to 255."""
    shares = [channel / 255 for channel in channels]
    red, green, blue = (
        share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4 for share in shares
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue
