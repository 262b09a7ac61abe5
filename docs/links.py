"""Checks the links of the built documentation site without the network.

    python docs/links.py build/site

Every link and picture of a page must lead to a file of the site, and every anchor to an element of its page.
Links to other sites are not opened. Prints each broken link; the exit status is 1 if there is any.
"""

import sys
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

ELSEWHERE = ("http", "https", "mailto", "data", "javascript")
"""Schemes of links that leave the site."""


class Page(HTMLParser):
    """Links and anchors of an HTML page."""

    def __init__(self, text: str):
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("href", "src") and value:
                self.links.append(value)
            if name == "id" and value:
                self.anchors.add(value)


@cache
def page(path: Path) -> Page:
    """The page at a path."""
    return Page(path.read_text(encoding="utf-8"))


def broken(site: Path) -> list[str]:
    """Every broken link of a site, with the page that has it."""
    found = []
    for path in sorted(site.rglob("*.html")):
        for link in page(path).links:
            parts = urlsplit(link)
            if parts.scheme in ELSEWHERE or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            exists = target.is_file()
            if exists and parts.fragment and target.suffix == ".html":
                exists = unquote(parts.fragment) in page(target).anchors
            if not exists:
                found.append(f"{path.relative_to(site)}: {link}")
    return found


if __name__ == "__main__":
    lines = broken(Path(sys.argv[1]).resolve())
    print("\n".join(lines))
    sys.exit(1 if lines else 0)
