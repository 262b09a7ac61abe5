"""The state of the page, as texts of the controls; can be saved, loaded, and sent as an address."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import isnan
from typing import Any
from urllib.parse import parse_qsl, urlencode

from ..api.arm import Arm
from ..api.rod import SoftRod
from ..config.document.reading import yaml_of
from ..config.document.refusals import hint_of
from ..config.tasks import CONFIGS
from ..config.values import overflows, short
from ..errors import InputError
from ..model.parameters import OPTIONAL_PARAMETERS

LAWS: dict[str, dict[str, str]] = {
    "linear": {},
    "fixed": {"law": "neo_hookean", "section": "fixed"},
    "swelling": {"law": "neo_hookean", "section": "swelling"},
}
"""Keys of the section `material` for each choice of the law."""
LAW_NAMES = {
    "linear": "linear",
    "fixed": "neo-Hookean, fixed section",
    "swelling": "neo-Hookean, swelling section",
}
ROD = {"F": "50", "k1": "1e4", "k2": "100", "gamma3": "0.01", "gamma1": "1", "taper": "1"}
"""The first rod to show: the rod of the paper's Fig. 5, which flutters."""
ARM = {"length": "10 cm", "radius": "5 mm", "young": "100 kPa", "viscosity": "12 Pa s", "pressure": "4 kPa"}
"""The first arm to show: silicone in silicone oil."""
TABS = {"rod": ROD, "arm": ARM}
ACROSS = {"rod": ("k2", "k1", "gamma3", "taper"), "arm": ("length", "radius", "young", "viscosity")}
"""Second parameter of the diagram, beside the load; the first is the default."""
DEFAULT_F_MAX = "200"


@dataclass(frozen=True, kw_only=True)
class PageState:
    """Values of the controls, in the user's notation."""

    tab: str = "rod"
    """The tab to solve: "rod" or "arm"."""
    rod: Mapping[str, str] = field(default_factory=lambda: dict(ROD))
    """Texts of the tab "rod" by name."""
    arm: Mapping[str, str] = field(default_factory=lambda: dict(ARM))
    """Texts of the tab "arm" by name."""
    law: str = "linear"
    """Constitutive law, a key of `LAWS`."""
    across: str = ""
    """Second parameter of the diagram."""
    F_max: str = DEFAULT_F_MAX
    """Largest force of thresholds, branches and diagram."""

    @property
    def values(self) -> Mapping[str, str]:
        """Texts of the current tab by name."""
        return self.rod if self.tab == "rod" else self.arm

    @property
    def second(self) -> str:
        """Second parameter of the diagram."""
        return self.across if self.across in ACROSS[self.tab] else ACROSS[self.tab][0]

    @property
    def load(self) -> str:
        """Name of the load on the current tab."""
        return "F" if self.tab == "rod" else "pressure"

    def with_values(self, **changed: str) -> "PageState":
        """A copy with changed texts on the current tab."""
        values = {**self.values, **changed}
        return replace(self, rod=values) if self.tab == "rod" else replace(self, arm=values)

    def subject(self) -> SoftRod | Arm:
        """The rod or the arm; InputError, as on the command line, for invalid values."""
        material: dict[str, Any] = dict(LAWS[self.law])
        if self.tab == "arm":
            return Arm(**{name: text.strip() for name, text in self.arm.items()}, **material)
        for name, text in self.rod.items():
            if overflows(text.strip()):
                raise InputError(f"parameters.{name}: {short(text)} is too large for a floating-point number")
        return SoftRod(**self.parameters(), **material)

    def parameters(self) -> dict[str, Any]:
        """Parameters of the rod's tab by name, without a taper of 1; an invalid number stays a text."""
        found = {name: number(text) for name, text in self.rod.items()}
        return {name: value for name, value in found.items() if name != "taper" or value != 1}

    def largest_force(self) -> float:
        """`F_max` as a number; InputError unless it is finite and above 0."""
        value = number(self.F_max)
        if not (isinstance(value, float) and 0 < value < float("inf")):
            raise InputError(
                f"F_max = {short(self.F_max)} is not allowed; it must be a finite number above 0"
            )
        return value

    def address(self) -> str:
        """The query of the page's address, which `from_address` reads."""
        keys = {"tab": self.tab, **self.values, "law": self.law, "across": self.second, "F_max": self.F_max}
        return urlencode(keys)

    def yaml(self, task: str) -> str:
        """A config of `rodsweep run` with this rod or arm."""
        taken = (*CONFIGS[task].taken_of_a_rod({}), *OPTIONAL_PARAMETERS)
        values: dict[str, Any] = {n: v for n, v in self.parameters().items() if n in taken}
        if self.tab == "arm":
            values = {n: text for n, text in self.arm.items() if n != "pressure" or "F" in taken}
        tree: dict[str, Any] = {"task": task, "parameters": values if self.tab == "rod" else {"arm": values}}
        tree |= {"material": dict(LAWS[self.law])} if LAWS[self.law] else {}
        return yaml_of(tree)

    def python(self) -> str:
        """Python lines that solve this rod or arm."""
        made = f"{self.tab} = rs.{self.subject()!r}"
        return f"import rodsweep as rs\n\n{made}\n" + "".join(
            f"print({self.tab}.{method}())\n" for method in ("spectrum", "thresholds", "cycle")
        )


def rod_of(subject: SoftRod | Arm) -> Mapping[str, float]:
    """Dimensionless parameters of a rod or an arm."""
    return subject.parameters if isinstance(subject, SoftRod) else SoftRod(arm=subject).parameters


def number(text: str) -> Any:
    """A text as a number, or the text itself for a later error message."""
    try:
        value = float(text)
    except ValueError:
        return text
    return text if isnan(value) or overflows(text.strip()) else value


def from_address(query: str, default: PageState | None = None) -> PageState:
    """The state of an address; InputError for an unknown key or choice."""
    state = default or PageState()
    given = dict(parse_qsl(query.lstrip("?"), keep_blank_values=True))
    tab = _choice("tab", given.pop("tab", state.tab), TABS)
    state = replace(state, tab=tab)
    law = _choice("law", given.pop("law", state.law), LAWS)
    across = _choice("across", given.pop("across", state.second), ACROSS[tab])
    state = replace(state, law=law, across=across, F_max=given.pop("F_max", state.F_max))
    known = TABS[tab]
    for name in given:
        if name not in known:
            raise InputError(f"unknown key {short(name)} in the address; {hint_of(name, list(known))}")
    return state.with_values(**given)


def _choice(key: str, given: str, known: Any) -> str:
    """Checks that a word is known; InputError otherwise."""
    if given not in known:
        raise InputError(f"{key} = {short(given)} is not allowed; it must be {' or '.join(known)}")
    return given
