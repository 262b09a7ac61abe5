"""What is compiled: a cache for each content of the sources, and the same bits in every process."""

import shutil
import subprocess
import sys

from rodsweep.model import compilation

SOLVED_BEFORE = """
from rodsweep.solve.branch import branches
from rodsweep.solve.hopf import criticality
branches.warm_up()
criticality.warm_up()
"""
SOLVED = """
import rodsweep as rs
data = rs.sweep(
    "limit_cycle", parameters={"F": [20.0, 40.0, 41.0], "k1": 1e4, "k2": 1e2, "gamma3": 1e-2}, accuracy=1e-3,
    limit_cycle={"start": "neighbour", "samples": 8, "shapes": 4, "nodes": 5, "harmonics": 2},
)
for name in sorted(set(data.data_vars) - {"seconds"}):
    print(name, data[name].values.tobytes().hex())
"""


def printed(code):
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout


def test_numbers_do_not_depend_on_what_was_loaded_before():
    """Of a compiled function and its copies in others a process would take the one that it loaded first."""
    alone = printed(SOLVED)
    assert "tip_y_max" in alone
    assert printed(SOLVED_BEFORE + SOLVED) == alone


def test_compiled_code_is_kept_for_one_content_of_the_sources(tmp_path, monkeypatch):
    """A change in a module whose formulas are inlined elsewhere must not meet old compiled code."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    copy = tmp_path / "rodsweep"
    for name in compilation.COMPILED_IN:
        shutil.copytree(compilation.PACKAGE / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(compilation, "PACKAGE", copy)
    before = compilation.cache_directory()
    assert before == compilation.cache_directory()
    assert copy in before.parents
    digests = {before}
    for formula in [path for name in compilation.COMPILED_IN for path in (copy / name).rglob("*.py")]:
        formula.write_text(formula.read_text() + "# changed\n")
        digests.add(compilation.cache_directory())
    assert len(digests) == 1 + sum(1 for name in compilation.COMPILED_IN for _ in (copy / name).rglob("*.py"))
    assert any("compiled" in path.read_text() for path in copy.glob("*/*/*.py")), "rooms have formulas too"
    monkeypatch.setenv("NUMBA_CACHE_DIR", "/elsewhere")
    assert str(compilation.cache_directory()).startswith("/elsewhere/compiled-")
