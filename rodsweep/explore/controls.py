"""Sliders, text fields and menus of the page, and a timer for pauses of the user. Every change by the user is
reported by the name and the new text of the changed value."""

from collections.abc import Callable
from functools import partial
from typing import Any

from bokeh.document import Document
from bokeh.models import Column, InlineStyleSheet, Select, Slider, TabPanel, Tabs, TextInput
from bokeh.models.css import StyleSheet

from ..post.summary.arm.arm_texts import printed_quantity_name
from .page_state import LAW_MENU_ENTRIES, SECOND_PARAMETERS, TAB_DEFAULTS, PageState
from .slider_scales import SLIDER_SCALES, PictureAxis, SliderScale

LABEL_OF_MAX_FORCE = "Largest force F (k3/L^2)"
SLIDER_STEP_COUNT = 400
"""Number of steps of a slider between its ends."""
ChangeCallback = Callable[..., None]


class SliderField:
    """Text field and slider for the same value. A change of the field or of the slider calls `changed(name,
    text)`."""

    def __init__(self, scale: SliderScale, changed: Callable[[str, str], None], sheets: list[StyleSheet]):
        self.scale = scale
        self.changed = changed
        start, end = scale.end_positions
        self.text = TextInput(
            title=scale.label, name=f"{scale.name}_field", sizing_mode="stretch_width", stylesheets=sheets
        )  # fmt: skip
        self.slider = Slider(
            start=start, end=end, value=start, step=(end - start) / SLIDER_STEP_COUNT, show_value=False,
            name=f"{scale.name}_slider", sizing_mode="stretch_width", stylesheets=sheets,
        )  # fmt: skip
        self.text.on_change("value", self._on_text_change)
        self.slider.on_change("value", self._on_slider_change)
        self.root = Column(self.text, self.slider, sizing_mode="stretch_width", spacing=0)
        self._is_updating = False
        """True while the page itself changes widgets; callbacks of the widgets then return at once."""
        self._sliding = False

    def show(self, text: str) -> None:
        """Shows `text` in the field, and moves the slider to the value of `text` unless the user is dragging
        the slider."""
        self._is_updating = True
        try:
            self.text.value = text
            position = self.scale.position(text)
            if position is not None and not self._sliding:
                self.slider.value = position
        finally:
            self._is_updating = False

    def _on_text_change(self, attribute: str, previous: str, text: str) -> None:
        if not self._is_updating:
            self.changed(self.scale.name, text)

    def _on_slider_change(self, attribute: str, previous: float, position: float) -> None:
        if self._is_updating:
            return
        self._sliding = True
        try:
            self.changed(self.scale.name, self.scale.text_at(position))
        finally:
            self._sliding = False


class Controls:
    """All controls of the page.

    changed: callback; its keywords are the changed fields of `PageState`, or `values`, the changed texts of
    the tab by name.
    """

    def __init__(self, changed: ChangeCallback, style_sheet: InlineStyleSheet):
        self._changed = changed
        self._is_updating = False
        sheets: list[StyleSheet] = [style_sheet]
        self.fields = {
            tab: {
                name: SliderField(scale, lambda name, text: changed(values={name: text}), sheets)
                for name, scale in scales.items()
            }
            for tab, scales in SLIDER_SCALES.items()
        }
        panels = [
            TabPanel(
                title={"rod": "Rod", "arm": "Arm, SI units"}[tab],
                child=Column(
                    *(field.root for field in fields.values()), sizing_mode="stretch_width", spacing=2
                ),
            )
            for tab, fields in self.fields.items()
        ]
        self.tabs = Tabs(tabs=panels, sizing_mode="stretch_width", name="tabs", stylesheets=sheets)
        self.tabs.on_change("active", self._tab_changed)
        new_select = partial(Select, sizing_mode="stretch_width", stylesheets=sheets)
        self.law = new_select(title="Law of the material", name="law", options=list(LAW_MENU_ENTRIES.items()))
        self.across = new_select(title="Second parameter of the diagram", name="across")
        self.F_max = TextInput(
            title=LABEL_OF_MAX_FORCE, name="F_max", sizing_mode="stretch_width", stylesheets=sheets
        )
        for key, widget in (("law", self.law), ("across", self.across), ("F_max", self.F_max)):
            widget.on_change("value", partial(self._choice_changed, key))
        self.root = Column(
            self.tabs, self.law, self.F_max, self.across, sizing_mode="stretch_width", name="controls"
        )

    def show(self, state: PageState) -> None:
        """Sets all controls to the values of `state`."""
        self._is_updating = True
        try:
            self.tabs.active = list(TAB_DEFAULTS).index(state.tab)
            for name, field in self.fields[state.tab].items():
                field.show(state.visible_texts[name])
            self.law.value = state.law
            self.across.options = [
                (name, printed_quantity_name(name)) for name in SECOND_PARAMETERS[state.tab]
            ]
            self.across.value = state.second_parameter
            self.F_max.value = state.F_max
        finally:
            self._is_updating = False

    def show_largest_pressure(self, state: PageState, axis: PictureAxis) -> None:
        """Sets the title of the field of the largest force; for an arm, the title states the corresponding
        pressure. axis: axis of the load."""
        pressure_clause = (
            f": {state.largest_force() * axis.factor_from_dimensionless:.4g} kPa"
            if state.tab == "arm"
            else ""
        )
        self.F_max.title = LABEL_OF_MAX_FORCE + pressure_clause

    def _tab_changed(self, attribute: str, previous: int, tab: int) -> None:
        if not self._is_updating:
            self._changed(tab=list(TAB_DEFAULTS)[tab])

    def _choice_changed(self, key: str, attribute: str, previous: Any, choice: Any) -> None:
        if not self._is_updating:
            self._changed(**{key: choice})


PAUSE_MILLISECONDS = 900
"""Requests that take seconds are sent when the controls have not changed for this time, in milliseconds."""


class PauseTimer:
    """Runs `callback` on the event loop of a document once the controls have not changed for a while:
    PAUSE_MILLISECONDS after the last `restart`."""

    def __init__(self, document: Document, callback: Callable[[], None]):
        self.document = document
        self.callback = callback
        self._scheduled: Callable[[], None] | None = None

    def restart(self) -> None:
        """Starts the waiting time; a waiting time that is running starts again from its beginning."""
        self.cancel()
        self._scheduled = self.document.add_timeout_callback(self._run, PAUSE_MILLISECONDS)

    def cancel(self) -> None:
        """Ends the waiting time without the callback."""
        if self._scheduled is not None:
            self.document.remove_timeout_callback(self._scheduled)
            self._scheduled = None

    def _run(self) -> None:
        self._scheduled = None
        self.callback()
