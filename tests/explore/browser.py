"""A headless Chromium, driven through Debian's chromedriver by the W3C protocol."""

import base64
import json
import shutil
import socket
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Sequence
from io import BytesIO
from typing import Any

import pytest
from PIL import Image

NEEDED = ("chromium", "chromedriver")
LONGEST = 600.0
"""Seconds that a loaded machine may need for anything. The solver processes of branches have a niceness of
15: on a machine with fifteen other processes on two cores they get a thirtieth of a core."""
needs_browser = pytest.mark.skipif(
    not all(map(shutil.which, NEEDED)), reason="Debian's chromium and chromium-driver are not installed"
)


class Browser:
    """One window of a headless browser; a context manager."""

    def __init__(self, width: int = 1280, height: int = 1300, dark: bool = False):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self._driver = subprocess.Popen(
            ["chromedriver", f"--port={port}", "--silent"], stdout=subprocess.DEVNULL
        )
        self._base = f"http://127.0.0.1:{port}"
        self._wait_for_driver()
        arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", f"--window-size={width},{height}"]
        arguments += ["--blink-settings=preferredColorScheme=0"] if dark else []
        always = {"goog:chromeOptions": {"args": arguments}, "goog:loggingPrefs": {"browser": "ALL"}}
        session = self._call("POST", "/session", {"capabilities": {"alwaysMatch": always}})
        self._base += f"/session/{session['sessionId']}"

    def __enter__(self) -> "Browser":
        return self

    def __exit__(self, *_: object) -> None:
        try:
            self._call("DELETE", "")
        finally:
            self._driver.terminate()
            self._driver.wait()

    def show(self, url: str) -> None:
        """Opens any page."""
        self._call("POST", "/url", {"url": url})

    def open(self, url: str) -> None:
        """Opens a page, and waits until Bokeh has drawn it."""
        self.show(url)
        self.wait_for("window.Bokeh && Bokeh.documents.length && Bokeh.documents[0].is_idle")

    def resize(self, width: int, height: int) -> None:
        """Changes the size of the visible part of the page; a window is at least 500 pixels wide."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        body = {"cmd": "Emulation.setDeviceMetricsOverride", "params": size}
        self._call("POST", "/goog/cdp/execute", body)

    def run(self, script: str, *arguments: object) -> Any:
        """The value that JavaScript returns."""
        return self._call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def model(self, name: str, attribute: str) -> Any:
        """An attribute of the model with a name."""
        return self.run(f"return Bokeh.documents[0].get_model_by_name(arguments[0]).{attribute}", name)

    def wait_for(self, condition: str) -> None:
        """Waits until a condition in JavaScript holds; AssertionError after `LONGEST`."""
        end = time.monotonic() + LONGEST
        while not self.run(f"return !!({condition})"):
            assert time.monotonic() < end, condition
            time.sleep(0.05)

    def click(self, figure: str, x: float, y: float) -> None:
        """Clicks into a figure, at data coordinates."""
        self.drag(figure, [(x, y)])

    def drag(self, figure: str, places: Sequence[tuple[float, float]]) -> None:
        """Drags through places in a figure, given in data coordinates."""
        self._drag([self._move_to(figure, *place) for place in places])

    def drag_at_shares(self, figure: str, shares: Sequence[tuple[float, float]]) -> None:
        """Drags through places in a figure, given as shares of the width and the height of its frame."""
        box = self.run(
            "const view = Bokeh.index.find_one(Bokeh.documents[0].get_model_by_name(arguments[0]));"
            "view.el.scrollIntoView({block: 'center'});"
            "const {left, top} = view.canvas_view.el.getBoundingClientRect(), {bbox} = view.frame;"
            "return [left + bbox.x, top + bbox.y, bbox.width, bbox.height]",
            figure,
        )
        places = [(box[0] + x * box[2], box[1] + y * box[3]) for x, y in shares]
        self._drag([self._move(*place) for place in places])

    def _drag(self, moves: list[dict[str, Any]]) -> None:
        press, release = ({"type": f"pointer{what}", "button": 0} for what in ("Down", "Up"))
        actions = [moves[0], press, *moves[1:], release]
        pointer = {"type": "pointer", "id": "mouse", "actions": actions}
        self._call("POST", "/actions", {"actions": [pointer]})

    def _move_to(self, figure: str, x: float, y: float) -> dict[str, Any]:
        """The action that moves the pointer to data coordinates of a figure."""
        place = self.run(
            "const view = Bokeh.index.find_one(Bokeh.documents[0].get_model_by_name(arguments[0]));"
            "view.el.scrollIntoView({block: 'center'});"
            "const box = view.canvas_view.el.getBoundingClientRect();"
            "return [box.left + view.frame.x_scale.compute(arguments[1]),"
            " box.top + view.frame.y_scale.compute(arguments[2])]",
            figure,
            x,
            y,
        )
        return self._move(*place)

    def _move(self, x: float, y: float) -> dict[str, Any]:
        return {"type": "pointerMove", "duration": 30, "x": round(x), "y": round(y)}

    def screenshot(self) -> Image.Image:
        """The visible part of the page."""
        taken = base64.b64decode(self._call("GET", "/screenshot"))
        return Image.open(BytesIO(taken)).convert("RGB")

    def complaints(self) -> list[str]:
        """Warnings and errors on the console since the last call."""
        entries = self._call("POST", "/se/log", {"type": "browser"})
        return [entry["message"] for entry in entries if entry["level"] in ("WARNING", "SEVERE")]

    def _call(self, method: str, path: str, body: dict | None = None) -> Any:
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(
            self._base + path, data, {"Content-Type": "application/json"}, method=method
        )
        try:
            with urllib.request.urlopen(request, timeout=LONGEST) as answer:
                return json.loads(answer.read())["value"]
        except urllib.error.HTTPError as error:
            raise AssertionError(error.read().decode()) from None

    def _wait_for_driver(self) -> None:
        end = time.monotonic() + LONGEST
        while True:
            try:
                self._call("GET", "/status")
                return
            except OSError:
                assert time.monotonic() < end, "chromedriver does not start"
                time.sleep(0.05)
