"""What only `make survey` runs: a marker, the number of random rods, and the cases beyond the first few."""

import os
from collections.abc import Iterable, Sequence
from typing import TypeVar

import pytest

RODS = int(os.environ.get("RODSWEEP_RODS", "0"))
survey_only = pytest.mark.skipif(not RODS, reason="make survey runs it")
Case = TypeVar("Case")


def few(cases: Sequence[Case], count: int) -> Sequence[Case]:
    """The first cases, so many of them; all where `make survey` runs."""
    return cases if RODS else cases[:count]


def only(kept: Sequence[str], names: Iterable[str]) -> list:
    """Names as parameters of a test, of which `make survey` alone takes those that are not among the kept."""
    return [pytest.param(name, marks=() if name in kept else survey_only) for name in names]
