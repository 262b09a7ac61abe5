"""What is compiled: each kernel once for all that it is made of, and the same bits in every process."""

import importlib
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from numba.core import event
from surveyed import few

from rodsweep.model.compiled import cache, compilation
from rodsweep.model.rod import Rod

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
PASSES_COUNTED = """
from numba.core import event
passes = event.RecordingListener()
event.register("numba:run_pass", passes)
"""
PASSES_TOLD = "print('passes', len(passes.buffer))"

INNER = '''
"""Formulas that those of another module call."""
from typing import NamedTuple
from rodsweep.model.compiled.compilation import compiled

FACTOR = 2.0

class Pair(NamedTuple):
    a: float
    b: float

@compiled
def scaled(x):
    """A product."""
    return FACTOR * x

@compiled
def alone(x):
    return x + 1.0
'''
OUTER = """
import numpy as np
from .inner import Pair, alone, compiled, scaled

OFFSETS = np.array([10.0, 20.0])

@compiled
def shifted(x):
    return scaled(x) + OFFSETS[0]

@compiled
def twice_shifted(x):
    return [shifted(y) for y in (x, x)][1]

@compiled
def difference(p):
    return p.a - p.b

@compiled
def calls_later(x):
    return later(x)

@compiled
def later(x):
    return 3.0 * x

def values():
    return alone(1.0), twice_shifted(1.0), difference(Pair(5.0, 3.0)), calls_later(1.0)
"""
VALUES = 2.0, 12.0, 2.0, 3.0
KERNELS = {"alone", "scaled", "shifted", "twice_shifted", "difference", "calls_later", "later"}


def run_python(code):
    return subprocess.run([sys.executable, "-c", code], check=False, capture_output=True, text=True)


def printed(code):
    done = run_python(code)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.long
def test_numbers_do_not_depend_on_what_was_loaded_before():
    """Of a compiled function and its copies in others a process would take the one that it loaded first."""
    alone = printed(PASSES_COUNTED + SOLVED + PASSES_TOLD)
    assert "tip_y_max" in alone
    assert alone == printed(SOLVED_BEFORE + SOLVED) + "passes 0\n", "it was compiled twice"


@pytest.fixture
def made(tmp_path, monkeypatch):
    """Imports a package of the two modules given as in a new process: its values, and what numba compiled."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(
        sys, "dont_write_bytecode", True
    )  # of equal size and time it would be taken for fresh
    (tmp_path / "made").mkdir()

    def values(inner=INNER, outer=OUTER):
        for name in [name for name in sys.modules if name.partition(".")[0] == "made"]:
            del sys.modules[name]
        for name, content in (("__init__", ""), ("inner", inner), ("outer", outer)):
            (tmp_path / "made" / f"{name}.py").write_text(content)
        importlib.invalidate_caches()
        outer = importlib.import_module("made.outer")
        with event.install_recorder("numba:compile") as recorder:
            found = outer.values()
        return found, {seen.data["dispatcher"].__name__ for _, seen in recorder.buffer}

    yield values
    for name in [name for name in sys.modules if name.partition(".")[0] == "made"]:
        del sys.modules[name]


def test_comments_docstrings_and_lines_compile_nothing(made):
    assert made() == (VALUES, KERNELS)
    assert made() == (VALUES, set())
    moved = INNER.replace('    """A product."""\n', "    # a comment\n").replace("\n@", "\n\n# another\n\n@")
    commented = OUTER.replace("    return p.a", '    """A docstring where there was none."""\n    return p.a')
    assert made(moved, commented) == (VALUES, set())


@pytest.mark.long
@pytest.mark.parametrize(
    ("old", "new", "compiled", "changed"),
    [
        ("FACTOR = 2.0", "FACTOR = 3.0", {"scaled", "shifted", "twice_shifted"}, {1: 13.0}),
        ("FACTOR * x", "FACTOR * x * x", {"scaled", "shifted", "twice_shifted"}, {}),
        ("10.0, 20.0", "11.0, 20.0", {"shifted", "twice_shifted"}, {1: 13.0}),
        ("(x, x)][1]", "(x, x + 1.0)][1]", {"twice_shifted"}, {1: 14.0}),
        ("3.0 * x", "4.0 * x", {"calls_later", "later"}, {3: 4.0}),
        ("    a: float\n    b: float", "    b: float\n    a: float", {"difference"}, {2: -2.0}),
        ("p.a - p.b", "p.b - p.a", {"difference"}, {2: -2.0}),
        ("@compiled\ndef alone", "@compiled_with_reordered_sums\ndef alone", {"alone"}, {}),
    ],
)
def test_a_change_compiles_the_kernel_and_its_callers_only(made, old, new, compiled, changed):
    """The constant, the callee or the order of fields is in another module, or defined below its user."""
    inner = INNER.replace("import compiled", "import compiled, compiled_with_reordered_sums")
    made(inner)
    values = tuple(changed.get(place, value) for place, value in enumerate(VALUES))
    assert made(inner.replace(old, new), OUTER.replace(old, new)) == (values, compiled)
    assert made(inner) == (VALUES, set()), "versions share the directory"


def test_a_class_that_moved_to_another_module_compiles_its_kernels_anew(made):
    """What was compiled refers to the class by its module, which may be gone."""
    pair = "class Pair(NamedTuple):\n    a: float\n    b: float\n"
    outer = OUTER.replace("import Pair, alone", "import NamedTuple, alone").replace(
        "@compiled", f"{pair}\n@compiled", 1
    )
    made()
    assert made(INNER.replace(pair, ""), outer) == (VALUES, {"difference"})


def test_what_was_compiled_of_an_outdated_value_is_not_kept(made, monkeypatch):
    """A constant that a running process changed: numba has the first value in some kernels, not in others."""
    made()
    monkeypatch.setattr(sys.modules["made.inner"], "FACTOR", 100.0)
    assert sys.modules["made.outer"].shifted(1) == 110.0, "compiled for an integer only now"
    made()
    assert sys.modules["made.outer"].shifted(1) == 12.0


def test_a_value_that_has_no_digest_is_refused(made):
    with pytest.raises(TypeError, match=r"scaled is compiled and reads <object.* has no digest"):
        made(INNER.replace("FACTOR = 2.0", "FACTOR = object()"))
    with pytest.raises(TypeError, match="kernels take no functions as arguments"):
        made(outer=OUTER.replace("difference(Pair(5.0, 3.0))", "difference(shifted)"))


def test_numba_looks_for_caches_where_ours_is():
    """numba calls what its class `_Cache` promises; `_cache` is where it looks."""
    kernel = compilation.compiled(lambda x: x)
    assert isinstance(kernel._cache, numba.core.caching._Cache)
    assert kernel.stats.cache_path == str(cache.cache_directories()[0])


@pytest.mark.parametrize(
    "spoil", few([lambda held: held[:100], lambda held: b"garbage", lambda held: b""], 1)
)
def test_damaged_files_are_compiled_and_written_again(made, tmp_path, spoil):
    made()
    files = sorted((tmp_path / "cache").rglob("*.kernel"))
    assert len(files) == len(KERNELS)
    for file in files:
        file.write_bytes(spoil(file.read_bytes()))
    assert made() == (VALUES, KERNELS)
    assert made() == (VALUES, set())


FULL = """
import resource, sys
sys.path.insert(0, {place!r})
import numba
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
from made import outer
print(outer.values())
"""


@pytest.mark.long
def test_a_full_disk_costs_the_cache_and_nothing_else(made, tmp_path):
    """A limit on the size of files fails in `write` as a full disk does."""
    made()
    for file in (tmp_path / "cache").rglob("*.kernel"):
        file.unlink()
    done = run_python(FULL.format(place=str(tmp_path)))
    assert (done.returncode, done.stdout) == (0, f"{VALUES}\n")
    assert done.stderr.count(f"compiled formulas cannot be stored in {tmp_path}") == 1
    assert [path for path in (tmp_path / "cache").rglob("*") if path.is_file()] == []


def test_an_installation_that_cannot_be_written_is_read(made, tmp_path, monkeypatch):
    """What is not in it goes to the user's cache; a file in the way of a directory stops root too."""
    made()
    installed, home = tmp_path / "cache" / "rodsweep", tmp_path / "home"
    kept = sorted(installed.iterdir())
    kept[0].unlink()
    monkeypatch.setattr(compilation, "cache_directories", lambda: [installed, home])
    assert len(made()[1]) == 1
    shutil.rmtree(installed)
    installed.write_text("no directory")
    assert len(made()[1]) == len(KERNELS)
    assert len(list(home.iterdir())) == len(KERNELS)
    assert made() == (VALUES, set())


def test_places_of_the_cache(monkeypatch):
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", "/home/me")
    package = cache.PACKAGE_DIRECTORY / "__pycache__" / "compiled"
    assert cache.cache_directories() == [package, Path("/home/me/.cache/rodsweep/compiled")]
    monkeypatch.setenv("XDG_CACHE_HOME", "/scratch")
    assert cache.cache_directories() == [package, Path("/scratch/rodsweep/compiled")]
    monkeypatch.setenv("NUMBA_CACHE_DIR", "/elsewhere")
    assert cache.cache_directories() == [Path("/elsewhere/rodsweep")]


SETTINGS = """
from dataclasses import dataclass
from rodsweep.model.compiled.kernel_constants import KernelConstants
from rodsweep.model.compiled.compilation import compiled

@dataclass(frozen=True, slots=True, kw_only=True)
class HeldSettings(KernelConstants):
    count: int = 2
    sizes: tuple[float, ...] = (1.0, 2.0)

HELD = HeldSettings()

@compiled
def scaled(x):
    return HELD.count * x

@compiled
def alone(x):
    return x + HELD.sizes[0]
"""
READERS = """
from .inner import alone, scaled
def values():
    return scaled(3.0), alone(3.0)
"""


def test_a_changed_setting_compiles_the_functions_that_read_it(made):
    assert made(SETTINGS, READERS) == ((6.0, 4.0), {"scaled", "alone"})
    assert made(SETTINGS.replace("count: int = 2", "count: int = 5"), READERS) == ((15.0, 4.0), {"scaled"})
    assert made(SETTINGS.replace("(1.0, 2.0)", "(7.0, 2.0)"), READERS) == ((6.0, 10.0), {"alone"})
    reordered = SETTINGS.replace("    count: int = 2\n", "") + "\n"
    reordered = reordered.replace("(1.0, 2.0)\n", "(1.0, 2.0)\n    other: float = 9.0\n    count: int = 2\n")
    assert made(reordered, READERS) == ((6.0, 4.0), set())


def test_an_array_is_assigned_to_a_slice_of_its_shape_only_and_no_text_is_compiled(tmp_path, monkeypatch):
    """numba's own message states both shapes, which would be made to text in every compiled function."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))

    @compilation.compiled
    def assign(rows, row):
        rows[1] = row
        return rows.sum()

    assert assign(np.zeros((2, 3)), np.ones(3)) == 3.0
    with pytest.raises(ValueError, match="cannot assign"):
        assign(np.zeros((2, 3)), np.ones(2))
    (code,) = assign.inspect_llvm().values()
    assert "unicode" not in code


def test_whole_numbers_of_a_rod_compile_nothing_anew():
    """numba compiles a function once for each type of its arguments."""
    whole, real = Rod(F=50, k1=10000, k2=100, gamma3=1), Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1.0)
    assert numba.typeof(whole.coefficients) == numba.typeof(real.coefficients)
