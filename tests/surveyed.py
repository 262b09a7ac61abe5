"""Marker and number of random rods for the long tests that only `make survey` runs."""

import os

import pytest

RODS = int(os.environ.get("RODSWEEP_RODS", "0"))
survey_only = pytest.mark.skipif(not RODS, reason="make survey runs it")
