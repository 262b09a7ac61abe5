"""Fixtures shared by the tests: the command as a user runs it, and reference spectra."""

import compileall
import gc
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import ClassVar

import pytest
from faults import small
from faults.isolated import Isolated, isolated
from hypothesis import settings
from ranks import kill, ranks_in, wait_for_children
from surveyed import RODS

ROOT = Path(__file__).parents[1]

# The same examples on every machine, however busy: another sample is `make survey`.
settings.register_profile("same", derandomize=True, deadline=None, database=None, max_examples=40)
settings.load_profile("same")
BIN = Path(sys.executable).parent
RANK = ROOT / "tests" / "faults" / "rank.py"

LONGEST = (
    "test_slurm",
    "test_pages_run",
    "test_bad_files",
    "test_branch_task",
    "test_figure_layout",
    "test_bad_input",
    "test_extend",
    "test_paper",
    "test_arm_grids",
    "test_figures",
    "test_sweep_wide_work",
    "test_stop",
    "test_cycle_figures",
    "test_run",
    "test_report",
    "test_settings",
    "test_page",
    "test_stored",
    "test_dragged_tip",
    "test_browser",
    "test_stress",
    "test_interrupts",
    "test_start",
    "test_peers_limit_cycle",
    "test_arm_sweeps",
    "test_api",
    "test_arm_report",
    "test_generalised_hopf",
    "test_branch",
    "test_groups",
    "test_compilation",
    "test_modes",
    "test_cycles_task",
    "test_bench_sweep",
    "test_arm_validity",
    "test_hosts",
    "test_sentences",
    "test_docs",
    "test_coexistence",
)
"""Modules that take longest, begun first, so that no worker is left alone with one of them. Each stays on one
worker of pytest-xdist (`--dist loadfile`), which makes what its tests share once."""


def pytest_configure(config):
    """Compiles the package: where bytecode is not written, each process that a test starts would do it.

    For the same reason the tests as pytest rewrites them are kept: each worker would rewrite all of them.
    Before NumPy is loaded BLAS is given one core, as by the command: two workers' threads would compete.
    Ranks that wait leave the core to others: a test next door has something to do.
    Where the tests were started in the background SIGINT is ignored, and all processes would inherit that.
    """
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    os.environ.setdefault("OMPI_MCA_mpi_yield_when_idle", "1")
    sys.dont_write_bytecode = False
    if not hasattr(config, "workerinput"):  # the workers of pytest-xdist come later
        compileall.compile_dir(ROOT / "rodsweep", quiet=2)


@pytest.hookimpl(optionalhook=True)  # of pytest-xdist, which need not be there
def pytest_xdist_auto_num_workers(config):
    """One worker more than cores, four at most: some tests wait, and each worker loads all of it."""
    return min(len(os.sched_getaffinity(0)) + 1, 4)


def pytest_addoption(parser):
    parser.addoption("--long", action="store_true", help="run the tests that take long too, marked `long`")


def pytest_report_header(config):
    return [] if _takes_long_tests(config) else ["tests marked `long` are left out: make test-long runs them"]


def pytest_collection():
    """Collects no garbage while tests are collected: it would take half the time and find next to none."""
    gc.disable()


def pytest_collection_finish():
    """What is loaded by now stays, and collecting garbage would go through all of it each time."""
    gc.freeze()
    gc.enable()


def pytest_collection_modifyitems(config, items):
    """Puts first what takes longest, and leaves out what takes too long for every commit."""
    if not _takes_long_tests(config):
        config.hook.pytest_deselected(items=[item for item in items if item.get_closest_marker("long")])
        items[:] = [item for item in items if not item.get_closest_marker("long")]
    places = {name: place for place, name in enumerate(LONGEST)}
    items.sort(key=lambda item: places.get(item.path.stem, len(LONGEST)))


def _takes_long_tests(config) -> bool:
    """Whether tests marked `long` run: where they are asked for, by a marker, a name or for a survey."""
    named = any("::" in str(argument) for argument in config.args)
    return bool(config.getoption("--long") or config.option.markexpr or named or RODS)


NOT_FITTED = "from rodsweep.post.figures import request; request.fit_layout = lambda *_: None"
"""Patch with which figures are drawn but not laid out, which takes most of the time."""


class Started(subprocess.Popen):
    """A process that ends once the child of the loaded process to which it handed over has ended too."""

    directory: Path

    def wait(self, timeout: float | None = None) -> int:
        status = super().wait(timeout)
        if "mpiexec" not in self.args[0]:  # ranks may outlive their launcher
            wait_for_children(self.directory)
        return status


class Command:
    """`rodsweep` in a directory of its own, alone or under mpiexec."""

    _solved: ClassVar[dict[tuple[str, str, bytes], bytes]] = {}
    """The files that `solved` has made here, by name, text and lists of points of their configs."""

    def __init__(self, directory: Path, loaded: Callable[[], Isolated] | None = None):
        """`loaded`: gives the process from which runs without a launcher are forked, to save their start."""
        self.directory, self.loaded = directory, loaded
        self.left: list[tuple[subprocess.Popen, Path]] = []
        """Processes that were started, and where."""

    def in_directory(self, directory: Path) -> "Command":
        """The same in another directory."""
        there = Command(directory, self.loaded)
        there.left = self.left
        return there

    def clear(self) -> None:
        """Ends what a failing test has left running: ranks may wait for ever for what it would have done."""
        for process, directory in self.left:
            if process.poll() is None:
                kill(process.pid)
            kill(*ranks_in(directory).values())

    def argv(self, *words: object, ranks: int = 0, afresh: bool = True) -> list[str]:
        """The words that start processes; unless `afresh` each hands over to a child of a loaded one."""
        launcher = [str(BIN / "mpiexec"), "-n", str(ranks)] if ranks else []
        if afresh or not self.loaded:
            return [*launcher, str(BIN / "rodsweep"), *map(str, words)]
        return [*launcher, sys.executable, "-SE", str(RANK), str(self.loaded().ranks), *map(str, words)]

    def __call__(
        self, *words: object, ranks: int = 0, timeout: float = 300, patch: str = "", **variables: str
    ) -> subprocess.CompletedProcess:
        """Runs the command to its end. Every process executes `patch` first, with the variables added."""
        if ranks or not self.loaded:
            how = {"ranks": ranks, "patch": patch, "afresh": False}
            return self.afresh(*words, timeout=timeout, **how, **variables)
        run, limits = self.loaded(), {"seconds": None, "memory": None, "patience": timeout}
        ended = run(self.directory, *words, patch=patch, environment=variables, **limits)
        if ended.slow:
            raise subprocess.TimeoutExpired(list(map(str, words)), timeout, ended.out, ended.err)
        return subprocess.CompletedProcess(list(map(str, words)), ended.status, ended.out, ended.err)

    def drawn(self, *words: object) -> subprocess.CompletedProcess:
        """`plot` or `report` to its end, for tests that ignore the layout; laid out by `make survey`."""
        return self(*words, patch="" if RODS else NOT_FITTED)

    def solved(self, config: str, output: str = "") -> Path:
        """The result file of a config here, as a run of its own without a launcher gives it; the path.

        The runs of a config, by its text and lists of points, are one, whose file is copied: for tests that
        ask what is done with a file, not how it came. What compares two runs calls each.
        """
        source, path = self.directory / config, self.directory / (output or f"{config.rpartition('.')[0]}.h5")
        assert not path.exists()
        lists = b"".join(path.read_bytes() for path in sorted(self.directory.glob("*.csv")))
        key = (config, source.read_text(), lists)
        if key not in self._solved:
            done = self("run", config, "-o", path.name)
            assert done.returncode in (0, 1), done.stderr  # points may fail
            self._solved[key] = path.read_bytes()
        path.write_bytes(self._solved[key])
        return path

    def afresh(self, *words: object, timeout: float = 300, **how) -> subprocess.CompletedProcess:
        """The same in processes of its own, without a launcher too."""
        process = self.started(*words, **{"afresh": True} | how)
        try:
            out, err = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            self.clear()
            raise
        return subprocess.CompletedProcess(process.args, process.returncode, out, err)

    def started(
        self,
        *words: object,
        ranks: int = 0,
        patch: str = "",
        afresh: bool = False,
        stdout=subprocess.PIPE,
        **variables: str,
    ) -> subprocess.Popen:
        """The processes, started and left running, in a session of their own."""
        process = Started(
            self.argv(*words, ranks=ranks, afresh=afresh),
            cwd=self.directory,
            # As this process got it: MPI, once started in here, adds to the one in C.
            env=os.environ | {"COLUMNS": "1000"} | self._path_of(patch) | variables,
            stdout=stdout,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        process.directory = self.directory
        self.left.append((process, self.directory))
        return process

    def _path_of(self, patch: str) -> dict[str, str]:
        """PYTHONPATH with which every process executes `patch` when it starts."""
        if not patch:
            return {}
        place = self.directory / "patch"
        place.mkdir(exist_ok=True)
        (place / "sitecustomize.py").write_text(patch)
        return {"PYTHONPATH": os.pathsep.join(filter(None, [str(place), os.environ.get("PYTHONPATH")]))}

    def write(self, name: str, text: str) -> Path:
        path = self.directory / name
        path.write_text(text)
        return path


@pytest.fixture(scope="session")
def loaded(tmp_path_factory) -> Iterator[Isolated]:
    """Runs that are forked from a process which has loaded what every task needs."""
    directory = tmp_path_factory.mktemp("loaded")
    (directory / "points.csv").write_text(small.POINTS)
    paths = [directory / f"{name}.yaml" for name in small.CONFIGS | small.FURTHER]
    for path in paths:
        path.write_text((small.CONFIGS | small.FURTHER)[path.stem])
    with isolated(paths, solving=True) as run:
        yield run


@pytest.fixture
def command(tmp_path, request):
    command = Command(tmp_path, lambda: request.getfixturevalue("loaded"))
    yield command
    command.clear()


@pytest.fixture
def not_fitted(monkeypatch):
    """Figures are drawn but not laid out, for tests that ignore the layout; `make survey` lays them out."""
    if not RODS:
        monkeypatch.setattr("rodsweep.post.figures.request.fit_layout", lambda *_: None)


@pytest.fixture
def drawn(monkeypatch):
    """The figures that are drawn, in place of their files, and not laid out."""
    from matplotlib.figure import Figure

    figures: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: figures.append(figure))
    monkeypatch.setattr("rodsweep.post.figures.request.fit_layout", lambda *_: None)
    return figures


@pytest.fixture(scope="session")
def reference_spectra():
    return json.loads((ROOT / "tests" / "reference" / "spectra.json").read_text())
