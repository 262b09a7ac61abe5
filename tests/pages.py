"""Reads a page of `rodsweep report`: its elements, its tables, and what a browser would fetch for it."""

import re
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path

VOID = ("meta", "link", "img", "br", "hr", "input")
"""Elements of HTML without an end."""


@dataclass
class Page:
    """elements: (name, attributes, text within) of every element, in the order of their starts."""

    text: str
    elements: list[tuple[str, dict[str, str | None], list[str]]] = field(default_factory=list)

    def texts(self, name: str, **attributes: str) -> list[str]:
        """Texts of the elements of a name with these attributes; `class_` stands for class."""
        wanted = {key.rstrip("_"): value for key, value in attributes.items()}
        return [
            " ".join("".join(inner).split())
            for found, given, inner in self.elements
            if found == name and wanted.items() <= given.items()
        ]

    def values(self) -> list[list[str]]:
        """Lines under the pointer of every value of the figures."""
        return ["".join(inner).split("\n") for found, _, inner in self.elements[1:] if found == "title"][1:]

    def table(self, name: str) -> list[dict[str, str]]:
        """Rows of a table of results, all digits of each value by the heading."""
        (chunk,) = re.findall(rf"<summary>{name}: .*?</details>", self.text, re.DOTALL)
        heads = re.findall(r"<th(?: [^>]*)?>([^<]*)", chunk)
        rows = re.findall(r"<tr>(<td.*?)</tr>", chunk, re.DOTALL)
        cells = (re.findall(r'<td(?: title="([^"]*)")?>([^<]*)</td>', row) for row in rows)
        return [dict(zip(heads, (full or short for full, short in row), strict=True)) for row in cells]

    def asked_for(self) -> list[str]:
        """Addresses outside the page that a browser would fetch to show it, or that a link leads to."""
        found = []
        for _, attributes, _ in self.elements:
            for name, value in attributes.items():
                if name in ("src", "srcset", "data", "poster", "action") or name.endswith("href"):
                    found.append(value or "")
                found += re.findall(r"url\(['\"]?([^)'\"]*)", value or "")
        styles = " ".join(self.texts("style"))
        found += re.findall(r"url\(['\"]?([^)'\"]*)", styles) + re.findall(r"@import\s*([^;]*)", styles)
        return [address for address in found if not address.startswith(("#", "data:image/png;base64,"))]


class _Reader(HTMLParser):
    def __init__(self, page: Page):
        super().__init__()
        self.page = page
        self.open: list[int] = []

    def handle_starttag(self, tag, attrs):
        self.page.elements.append((tag, dict(attrs), []))
        if tag not in VOID:
            self.open.append(len(self.page.elements) - 1)

    def handle_startendtag(self, tag, attrs):
        self.page.elements.append((tag, dict(attrs), []))

    def handle_endtag(self, tag):
        assert self.page.elements[self.open[-1]][0] == tag, f"</{tag}> ends another element"
        self.open.pop()

    def handle_data(self, data):
        for place in self.open:
            self.page.elements[place][2].append(data)


def read_page(path: Path) -> Page:
    """The page of a file; AssertionError unless every element ends where it should."""
    page = Page(path.read_text(encoding="utf-8"))
    reader = _Reader(page)
    reader.feed(page.text)
    reader.close()
    assert reader.open == []
    return page
