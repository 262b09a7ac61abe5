"""What only `make survey` runs: further rods beside those that every run of the tests takes."""

import os

import pytest

RODS = int(os.environ.get("RODSWEEP_RODS", "0"))
survey_only = pytest.mark.skipif(not RODS, reason="make survey runs it")
