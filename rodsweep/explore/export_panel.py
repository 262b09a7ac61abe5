"""Export and import of texts and files by the page: address, config, Python lines, pictures, films."""

from base64 import b64decode, b64encode
from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path
from typing import Any

from bokeh.core.properties import String
from bokeh.model import DataModel
from bokeh.models import Button, Column, CustomJS, Div, FileInput, GlyphRenderer, Row, Select

from ..config.document.parsing import parsed_yaml
from ..config.document.reading import validated_config
from ..errors import InputError
from .page_state import PAGE_F_MAX, PageState
from .page_state_from_file import state_from_config
from .pictures.card import Card
from .templates_and_texts import style_sheet, template_text

ADDRESS_BAR_SCRIPT = 'history.replaceState(null, "", location.pathname + "?" + address.tags[0])'
"""Browser script that writes the state of the page into the address bar."""
SAVE_CONFIG_SCRIPT = 'download(new Blob([lines.config], {type: "application/yaml"}), "explore.yaml")'
"""Browser script that saves the config as a file."""
SAVE_FILM_SCRIPT = """
const bytes = Uint8Array.from(atob(film.tags[0]), (letter) => letter.charCodeAt(0))
if (bytes.length > 0) download(new Blob([bytes], {type: "image/gif"}), "explore.gif")
"""
"""Browser script that saves a film as a file."""
COPY_SCRIPT = "navigator.clipboard.writeText(lines.{})"
"""Browser script that copies a text to the clipboard. The format argument is the name of a field of
`ExportedLines`."""
CONFIG_TASKS = ["limit_cycle", "spectrum", "thresholds", "branch"]
"""Tasks for which the page writes a config; the first is the default."""
FILM_COMMANDS_COMMENT = """# the film of the arm:
# rodsweep run explore.yaml --set limit_cycle.shapes=48
# rodsweep plot explore.h5 --what animation -o explore.gif
"""
"""Comment at the end of a `limit_cycle` config: shell commands that make a film."""


class ExportedLines(DataModel):
    """Config and Python lines that the buttons copy and save. These texts are not part of the page's layout,
    so they are updated at every change of the controls."""

    config = String(default="")
    python = String(default="")


class ExportPanel:
    """Texts and buttons with which the user exports and imports the state of the page.

    cards: pictures that can be saved. arm: animated line of the arm. on_load: callback for the text of a
    config file that the user loads.
    """

    def __init__(self, cards: Sequence[Card], arm: GlyphRenderer, on_load: Callable[[str], None]):
        self._loaded = on_load
        self._state = PageState()
        widgets = style_sheet("widgets.css")
        texts = style_sheet("text.css")
        self.address, self.yaml, self.python = (
            Div(name=name, sizing_mode="stretch_width", stylesheets=[texts])
            for name in ("address", "yaml", "python")
        )
        self.shared_lines = ExportedLines()
        tasks = {"options": CONFIG_TASKS, "value": CONFIG_TASKS[0]}
        self.task = Select(title="Config of the task", name="task", **tasks, stylesheets=[widgets])
        self.task.on_change("value", self._choose_task)
        save = Button(label="Save the config", name="save_button", stylesheets=[widgets])
        save.js_on_click(_saving_script(SAVE_CONFIG_SCRIPT, lines=self.shared_lines))
        self.file = FileInput(title="Load a config", name="load", accept=".yaml,.yml", stylesheets=[widgets])
        self.file.on_change("value", self._load_chosen_file)
        copies = []
        for label, name, lines in (("config", "yaml", "config"), ("Python lines", "python", "python")):
            copies.append(Button(label=f"Copy the {label}", name=f"copy_{name}", stylesheets=[widgets]))
            copy_lines = CustomJS(args={"lines": self.shared_lines}, code=COPY_SCRIPT.format(lines))
            copies[-1].js_on_click(copy_lines)
        self.film = Div(name="film", tags=[""], visible=False)
        self.film.js_on_change("tags", _saving_script(SAVE_FILM_SCRIPT, film=self.film))
        self.address.js_on_change("tags", CustomJS(args={"address": self.address}, code=ADDRESS_BAR_SCRIPT))
        self.root = Column(
            self.address, self.task, self.yaml, Row(copies[0], save), self.file, self.python, copies[1],
            *_picture_buttons(cards, arm), self.film, name="sharing", sizing_mode="stretch_width",
        )  # fmt: skip

    def update_exported_texts(self, state: PageState) -> None:
        """Updates the texts that the buttons copy and save. The visible texts are updated by `show_texts`."""
        self._state = state
        self.shared_lines.update(config=self._config(), python=state.python())

    def show_texts(self) -> None:
        """Shows the page's address, and the Python lines and the YAML text of its latest state.

        The page calls this method only after a pause of the controls: each visible text causes a new layout,
        which would delay pictures that follow a slider, and browsers limit changes of the address to about
        six per second.
        """
        address = self._state.address()
        self.address.update(text=f'<a href="?{escape(address)}">This page as an address</a>', tags=[address])
        self.python.text = f"<pre>{escape(self.shared_lines.python)}</pre>"
        self.yaml.text = f"<pre>{escape(self.shared_lines.config)}</pre>"

    def save_film(self, gif: bytes) -> None:
        """Makes the browser save a film; gif: content of the file."""
        self.film.tags = [b64encode(gif).decode()]
        # Remove half a megabyte from the page; removal in the same message would prevent saving.
        self.film.document.add_next_tick_callback(lambda: self.film.update(tags=[""]))

    def _choose_task(self, attribute: str, previous: str, task: str) -> None:
        """Shows the config of the task that the user has chosen; the arguments, from Bokeh, are not used."""
        self.shared_lines.config = self._config()
        self.show_texts()

    def _config(self) -> str:
        """Config, as YAML text, for the task that the user has chosen."""
        text = self._state.yaml(self.task.value)
        return text + FILM_COMMANDS_COMMENT if self.task.value == CONFIG_TASKS[0] else text

    def _load_chosen_file(self, attribute: str, previous: str, content: str) -> None:
        """Passes the text of the chosen file to the page. content: content of the file in base64; empty after
        the field was cleared. The other arguments, from Bokeh, are not used."""
        if content:
            self._loaded(b64decode(content).decode(errors="replace"))
            self.file.clear()  # otherwise a browser does not report the same file when it is chosen again


def _picture_buttons(cards: Sequence[Card], arm: GlyphRenderer) -> list[Select | Row]:
    """Menu of the pictures `cards`, and a row of buttons, each of which saves the chosen picture in one file
    format. arm: animated line of the arm."""
    widgets = style_sheet("widgets.css")
    figures = {card.root.name: card.figure for card in cards}
    names = list(figures)
    selection = Select(title="Picture", name="picture", options=names, value=names[0], stylesheets=[widgets])
    buttons = []
    for kind in ("png", "svg"):
        button = Button(label=kind.upper(), name=f"{kind}_button", stylesheets=[widgets])
        arguments = {"figures": figures, "choice": selection, "type": kind, "animated": arm}
        button.js_on_click(_saving_script(template_text("picture.js"), **arguments))
        buttons.append(button)
    return [selection, Row(*buttons)]


def _saving_script(code: str, **arguments: Any) -> CustomJS:
    """Browser script that saves a file. code: lines of the script after the function `download`. arguments:
    Bokeh models and texts that the script uses, by name."""
    return CustomJS(args=arguments, code=template_text("download.js") + code)


def state_from_config_text(text: str, F_max: str = PAGE_F_MAX) -> PageState:
    """State of the page for `text`, a config in YAML. F_max: largest force if the config has none. For an
    invalid config, raises the same InputError as the command line."""
    source = "the loaded file"
    tree = parsed_yaml(text, source)
    if not isinstance(tree, dict):
        raise InputError(f"{source} does not consist of keys and values; give task and parameters")
    return state_from_config(validated_config(tree), Path(source), F_max)
