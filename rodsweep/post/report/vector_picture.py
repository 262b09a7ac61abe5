"""SVG element of a matplotlib figure for an HTML page, with texts under the pointer."""

from dataclasses import dataclass
from io import BytesIO
from xml.etree import ElementTree

import matplotlib
from matplotlib.figure import Figure

from .hover_points import hover_points

SVG_NAMESPACE = "http://www.w3.org/2000/svg"
XLINK_NAMESPACE = "http://www.w3.org/1999/xlink"
HOVER_RADIUS_IN_POINTS = "4"
"""Radius, in points, of the invisible circle around a value. The browser shows the title of the circle under
the pointer."""

ElementTree.register_namespace("", SVG_NAMESPACE)
ElementTree.register_namespace("xlink", XLINK_NAMESPACE)


@dataclass(frozen=True, slots=True)
class VectorPicture:
    """Figure as an SVG element of an HTML page. svg: text of the element. width: natural width, in
    points."""

    svg: str
    width: float


def vector_picture(figure: Figure, number: int, caption: str) -> VectorPicture:
    """The figure as an SVG element. number: number of the picture on the page. caption: description
    for readers who cannot see the picture."""
    written = BytesIO()
    # Pictures of a page must not share the names of their clipping paths.
    with matplotlib.rc_context({"svg.hashsalt": f"picture {number}", "svg.fonttype": "path"}):
        figure.savefig(written, format="svg", transparent=False, metadata={"Date": None})
    root = ElementTree.fromstring(written.getvalue())
    for element_path in ("metadata", "defs/style"):
        _remove_element(root, element_path)
    root.attrib.pop("height", None)
    width = float(root.attrib.pop("width").removesuffix("pt"))
    root.set("role", "img")
    root.set("aria-label", caption)
    _add_hover_texts(root, figure)
    return VectorPicture(ElementTree.tostring(root, encoding="unicode"), width)


def _remove_element(root: ElementTree.Element, element_path: str) -> None:
    """Removes the first element at a path below `root`. element_path: path of element names, such as
    "defs/style"."""
    *parents, name = element_path.split("/")
    parent = root.find("/".join(f"{{{SVG_NAMESPACE}}}{tag}" for tag in parents)) if parents else root
    if parent is not None and (found := parent.find(f"{{{SVG_NAMESPACE}}}{name}")) is not None:
        parent.remove(found)


def _add_hover_texts(root: ElementTree.Element, figure: Figure) -> None:
    """Adds to the SVG element `root` an invisible circle for each value of the figure; the title of
    the circle is the text under the pointer."""
    group = ElementTree.SubElement(root, f"{{{SVG_NAMESPACE}}}g", {"class": "values"})
    for point in hover_points(figure):
        circle_attributes = {"cx": f"{point.x:.1f}", "cy": f"{point.y:.1f}", "r": HOVER_RADIUS_IN_POINTS}
        circle = ElementTree.SubElement(group, f"{{{SVG_NAMESPACE}}}circle", circle_attributes)
        ElementTree.SubElement(circle, f"{{{SVG_NAMESPACE}}}title").text = point.text
