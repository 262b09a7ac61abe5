"""State of the page: the texts of all controls. The state can be written as address, config or Python
lines."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import isnan
from typing import Any
from urllib.parse import parse_qsl, urlencode

from ..api.arm import Arm
from ..api.rod import SoftRod
from ..config.document.reading import tree_yaml
from ..config.document.refusals import unknown_key_hint
from ..config.tasks import CONFIG_CLASSES_BY_TASK
from ..config.values import overflows_float
from ..errors import InputError, short_repr
from ..model.parameters import OPTIONAL_PARAMETER_NAMES
from ..model.units import load_over_flutter

MATERIAL_SECTION_BY_LAW: dict[str, dict[str, str]] = {
    "linear": {},
    "fixed": {"law": "neo_hookean", "section": "fixed"},
    "swelling": {"law": "neo_hookean", "section": "swelling"},
}
"""Keys of the config section `material`, by choice of the constitutive law on the page."""
LAW_MENU_ENTRIES = {
    "linear": "linear",
    "fixed": "neo-Hookean, fixed section",
    "swelling": "neo-Hookean, swelling section",
}
"""Menu entry for each choice of the constitutive law on the page."""
DEFAULT_ROD = {"F": "50", "k1": "1e4", "k2": "100", "gamma3": "0.01", "gamma1": "1", "taper": "1"}
"""Parameters of the rod with which the page opens: the rod of the paper's Fig. 5, which flutters."""
DEFAULT_ARM = {
    "length": "10 cm",
    "radius": "5 mm",
    "young": "100 kPa",
    "viscosity": "12 Pa s",
    "pressure": "4 kPa",
}
"""Quantities of the arm with which the page opens: silicone in silicone oil."""
TAB_DEFAULTS = {"rod": DEFAULT_ROD, "arm": DEFAULT_ARM}
"""Initial values on each tab, as texts by name."""
SECOND_PARAMETERS = {
    "rod": ("k2", "k1", "gamma3", "taper"),
    "arm": ("length", "radius", "young", "viscosity"),
}
"""Choices of the diagram's second parameter on each tab; the first is the default."""
PAGE_F_MAX = "200"
"""Largest force with which the page opens, in k3/L^2."""
LARGEST_FORCE_KEY_BY_TASK = {"thresholds": "F_max", "branch": "stop"}
"""Key of the largest force in the section of a task, by task."""


@dataclass(frozen=True, kw_only=True)
class PageState:
    """Values of all controls of the page, as texts in the user's notation."""

    tab: str = "rod"
    """Visible tab, "rod" or "arm": the rod or the arm of this tab is solved."""
    rod: Mapping[str, str] = field(default_factory=lambda: dict(DEFAULT_ROD))
    """Texts on the tab "rod", by name of the parameter."""
    arm: Mapping[str, str] = field(default_factory=lambda: dict(DEFAULT_ARM))
    """Texts on the tab "arm", by name of the quantity."""
    law: str = "linear"
    """Constitutive law, a key of `MATERIAL_SECTION_BY_LAW`."""
    across: str = ""
    """Second parameter of the diagram that the user has chosen; empty for the default of the tab."""
    F_max: str = PAGE_F_MAX
    """Largest force of thresholds, branches and diagram, in k3/L^2."""

    @property
    def visible_texts(self) -> Mapping[str, str]:
        """Texts on the visible tab, by name."""
        return self.rod if self.tab == "rod" else self.arm

    @property
    def second_parameter(self) -> str:
        """Second parameter of the diagram, on the vertical axis."""
        return self.across if self.across in SECOND_PARAMETERS[self.tab] else SECOND_PARAMETERS[self.tab][0]

    @property
    def load_name(self) -> str:
        """Name of the load on the visible tab."""
        return "F" if self.tab == "rod" else "pressure"

    def with_values(self, **changed: str) -> "PageState":
        """Copy of the state with changed texts on the visible tab."""
        values = {**self.visible_texts, **changed}
        return replace(self, rod=values) if self.tab == "rod" else replace(self, arm=values)

    def rod_or_arm(self) -> SoftRod | Arm:
        """Rod or arm of the visible tab. For invalid values, raises the same InputError as the command
        line."""
        material: dict[str, Any] = dict(MATERIAL_SECTION_BY_LAW[self.law])
        if self.tab == "arm":
            return Arm(**{name: text.strip() for name, text in self.arm.items()}, **material)
        for name, text in self.rod.items():
            if overflows_float(text.strip()):
                raise InputError(
                    f"parameters.{name}: {short_repr(text)} is too large for a floating-point number"
                )
        return SoftRod(**self.parameters(), **material)

    def parameters(self) -> dict[str, Any]:
        """Parameters of the tab "rod" as numbers by name, without a taper of 1. A text that is not a number
        is returned as text."""
        values = {name: float_or_text(text) for name, text in self.rod.items()}
        return {name: value for name, value in values.items() if name != "taper" or value != 1}

    @property
    def has_relative_load(self) -> bool:
        """Whether the load of the arm is relative to its flutter threshold, which must be solved first."""
        return self.tab == "arm" and load_over_flutter(self.arm[self.load_name].strip()) is not None

    def largest_force(self) -> float:
        """`F_max` as a number, in k3/L^2. Raises InputError unless the number is finite and positive."""
        value = float_or_text(self.F_max)
        if not (isinstance(value, float) and 0 < value < float("inf")):
            raise InputError(
                f"F_max = {short_repr(self.F_max)} is not allowed; it must be a finite number above 0"
            )
        return value

    def address(self) -> str:
        """Query string that encodes the state in the page's address; `from_address` reads it."""
        keys = {
            "tab": self.tab,
            **self.visible_texts,
            "law": self.law,
            "across": self.second_parameter,
            "F_max": self.F_max,
        }
        return urlencode(keys)

    def yaml(self, task: str) -> str:
        """Config for `rodsweep run`, in YAML, with the task `task` and the rod or arm of the visible tab."""
        used_names = (*CONFIG_CLASSES_BY_TASK[task].rod_parameters_used({}), *OPTIONAL_PARAMETER_NAMES)
        values: dict[str, Any] = {
            name: value for name, value in self.parameters().items() if name in used_names
        }
        if self.tab == "arm":
            values = {
                name: text for name, text in self.arm.items() if name != "pressure" or "F" in used_names
            }
        document: dict[str, Any] = {
            "task": task,
            "parameters": values if self.tab == "rod" else {"arm": values},
        }
        document |= (
            {"material": dict(MATERIAL_SECTION_BY_LAW[self.law])} if MATERIAL_SECTION_BY_LAW[self.law] else {}
        )
        if task in LARGEST_FORCE_KEY_BY_TASK:
            document[task] = {LARGEST_FORCE_KEY_BY_TASK[task]: self.largest_force()}
        return tree_yaml(document)

    def python(self) -> str:
        """Python lines that solve the rod or arm of the visible tab with `rodsweep`."""
        line = f"{self.tab} = rs.{self.rod_or_arm()!r}"
        return f"import rodsweep as rs\n\n{line}\n" + "".join(
            f"print({self.tab}.{method}())\n" for method in ("spectrum", "thresholds", "cycle")
        )


def dimensionless_parameters_of(rod_or_arm: SoftRod | Arm) -> Mapping[str, float]:
    """Dimensionless parameters, by name, of a rod or an arm."""
    return rod_or_arm.parameters if isinstance(rod_or_arm, SoftRod) else SoftRod(arm=rod_or_arm).parameters


def float_or_text(text: str) -> Any:
    """`text` as a float; the unchanged text if it is no number, NaN or too large, for a later error
    message."""
    try:
        value = float(text)
    except ValueError:
        return text
    return text if isnan(value) or overflows_float(text.strip()) else value


ADDRESS_KEYS_WITHOUT_QUANTITIES = ("tab", "law", "across", "F_max")
"""Keys of an address that name no parameter and no quantity."""


def from_address(query: str, default: PageState | None = None) -> PageState:
    """State of the page from the query string of its address. Raises InputError for an unknown name or
    choice. default: state whose values replace missing values of the query; None: `PageState()`."""
    state = default or PageState()
    query_values = dict(parse_qsl(query.lstrip("?"), keep_blank_values=True))
    tab = _require_choice("tab", query_values.pop("tab", state.tab), TAB_DEFAULTS)
    state = replace(state, tab=tab)
    law = _require_choice("law", query_values.pop("law", state.law), MATERIAL_SECTION_BY_LAW)
    second = _require_choice(
        "across", query_values.pop("across", state.second_parameter), SECOND_PARAMETERS[tab]
    )
    state = replace(state, law=law, across=second, F_max=query_values.pop("F_max", state.F_max))
    defaults = TAB_DEFAULTS[tab]
    for name in query_values:
        if name not in defaults:
            raise InputError(
                f"unknown key {short_repr(name)} in the address; "
                f"{unknown_key_hint(name, [*ADDRESS_KEYS_WITHOUT_QUANTITIES, *defaults])}"
            )
    return state.with_values(**query_values)


def _require_choice(key: str, value: str, allowed: Any) -> str:
    """Returns `value` if it is one of `allowed`; raises InputError otherwise. key: name of the choice, for
    the message."""
    if value not in allowed:
        raise InputError(f"{key} = {short_repr(value)} is not allowed; it must be {' or '.join(allowed)}")
    return value
