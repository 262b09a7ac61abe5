"""A parameter added to the table alone works everywhere, from the config to the figures' data."""

import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent / "with_new_parameter.py"


@pytest.mark.long
def test_a_new_parameter_is_one_entry_of_the_table(tmp_path):
    """Spectra, thresholds, cycles and branches are those of the rod with the drag that the factor makes."""
    run = subprocess.run(
        [sys.executable, HERE], cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.split()[-1] == "agreed"
