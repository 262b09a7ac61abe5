"""`rs.sweep`: a task over a grid or a list of points, in this process or on many MPI ranks."""

import os
import shutil
import subprocess
import sys
import traceback
import warnings
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import xarray as xr

from ..config.document.call_argument_errors import refusing_wrong_arguments
from ..config.document.reading import tree_yaml
from ..errors import EnvironmentIncomplete, InputError, short_repr
from ..sweep.progress import Display
from ..tasks.running.unforeseen_exceptions import describe_exception, traceback_log_path
from ..wording import counted
from .dataset import open_result
from .keyword_arguments import (
    ConfigTree,
    config_tree,
    job_of_tree,
    keyword_value_of_yaml_types,
    validated_point_count,
)
from .solving_in_process import progress_display, solve_in_process

EXIT_STATUSES_OF_COMPLETE_RUN = (0, 1)
"""Exit statuses of a complete run: 0 if all points succeeded, 1 if some points failed."""
EXCEPTION_OF_EXIT_STATUS: dict[int, type[Exception]] = {2: InputError, 3: EnvironmentIncomplete}
"""Class of the exception for each exit status of a run that was refused."""
RANKS_ALLOWED_FOR_ANY_SWEEP = 64
"""A sweep may have this number of ranks whatever the number of its points."""
MAX_QUOTED_STDERR_LENGTH = 2000
"""Maximum number of quoted characters of a run's standard error, enough for the last traceback."""


@refusing_wrong_arguments('rs.sweep("spectrum", F=[20, 30], k1=1e4, k2=100, gamma3=0.01)')
def sweep(
    task: str,
    *,
    ranks: int | None = None,
    strict: bool = False,
    progress: bool | None = None,
    **keywords: Any,
) -> xr.Dataset:
    """Solves a task at every point of a grid or list; returns a Dataset with the content of the file that
    `rodsweep run` writes.

    task: name of the task, such as "spectrum". keywords: the keys of a config, without sections. A parameter
    is a number, a list or array of increasing values, `linspace(...)` or `logspace(...)`. Instead of
    parameters, `points` may name a CSV file with the parameters of all points. `arm` is an `Arm` or a mapping
    of its quantities; tasks that find the load ignore the arm's load. `accuracy`, `title` and the options of
    the task may follow. Omitted keys have the config's defaults.

    ranks: number of MPI ranks, which `rodsweep run` starts; by default the points are solved in this process.
    strict: whether an unforeseen exception, a bug of rodsweep, is raised. By default the point has the status
    `failed`, a RuntimeWarning has the traceback, and the other points are solved. progress: whether to
    display the progress of the sweep and of a long point; by default only in a terminal or a notebook.

    Raises InputError for bad input, with the command line's message, and EnvironmentIncomplete if software is
    missing. A point that fails has a status other than success.
    """
    ranks = keyword_value_of_yaml_types("ranks", ranks)
    strict = keyword_value_of_yaml_types("strict", strict)
    if not isinstance(strict, bool):
        raise InputError(f"strict = {short_repr(strict)} is not allowed; it should be True or False")
    if ranks is not None and (isinstance(ranks, bool) or not isinstance(ranks, int) or ranks < 1):
        raise InputError(
            f"ranks = {short_repr(ranks)} is not allowed; it should be a whole number, 1 or above"
        )
    tree = config_tree(task, keywords)
    if ranks is not None:
        _refuse_idle_ranks(ranks, validated_point_count(tree))
        return _solve_on_ranks(task, tree, ranks, strict, progress_display(progress, None, task))
    return solve_in_process(job_of_tree(tree), None if strict else _warn_of_failed_points, progress).dataset


def _warn_of_failed_points(indices: Sequence[int], error: Exception) -> None:
    """Issues a RuntimeWarning with the traceback of the exception `error`, a bug of rodsweep, which made the
    points with the flat indices `indices` fail."""
    first = indices[0] + 1
    last_number = indices[-1] + 1
    points_text = f"point {first}" if first == last_number else f"points {first} to {last_number}"
    traceback_text = "".join(traceback.format_exception(error))
    warnings.warn(
        f"{points_text}: {describe_exception(error)}\n{traceback_text}", RuntimeWarning, stacklevel=2
    )


def _refuse_idle_ranks(ranks: int, points: int | None) -> None:
    """Raises InputError if the number of ranks exceeds RANKS_ALLOWED_FOR_ANY_SWEEP, the number of points, and
    the number of processors of this machine. points: None if not known; every number of ranks is then
    allowed."""
    max_ranks = max(os.cpu_count() or 1, points or 0, RANKS_ALLOWED_FOR_ANY_SWEEP)
    if points is not None and ranks > max_ranks:
        raise InputError(
            f"ranks = {short_repr(ranks)} is not allowed for {counted(points, 'point')}; ranks would be "
            f"idle; it should be at most {max_ranks}"
        )


def _solve_on_ranks(task: str, tree: ConfigTree, ranks: int, strict: bool, display: Display) -> xr.Dataset:
    """The Dataset of the task `task` that `rodsweep run` computes on `ranks` MPI ranks in a temporary
    directory. strict: whether an unforeseen exception, a bug of rodsweep, is raised. Raises
    EnvironmentIncomplete if mpiexec cannot be started, or the exception of `_run_failure_exception`."""
    points = tree["parameters"].get("points")
    if points is not None:
        tree = tree | {"parameters": tree["parameters"] | {"points": str(Path(points).absolute())}}
    with TemporaryDirectory(prefix="rodsweep-") as folder:
        config = Path(folder, f"{task}.yaml")
        output = Path(folder, f"{task}.h5")
        config.write_text(tree_yaml(tree), encoding="utf-8")
        command = [_mpiexec_path(), "-n", str(ranks), sys.executable, "-m", "rodsweep", "run", str(config)]
        command += ["-o", str(output), *(["--strict"] if strict else [])]
        try:
            status, errors = _run_with_progress(command, folder, display)
        except OSError as error:
            raise EnvironmentIncomplete(f"{command[0]} cannot be started: {error.strerror}") from None
        if status not in EXIT_STATUSES_OF_COMPLETE_RUN:
            raise _run_failure_exception(command[0], status, errors, is_file_created=output.exists())
        if (log := traceback_log_path(output)).exists():
            warnings.warn(log.read_text(encoding="utf-8"), RuntimeWarning, stacklevel=2)
        return open_result(output)


def _run_with_progress(words: list[str], folder: str, display: Display) -> tuple[int, str]:
    """Runs the command `words` in the directory `folder` and shows its progress; returns (exit status,
    standard error)."""
    # os.environ, as this process was started: a started MPI adds variables to the C environment only.
    run = subprocess.Popen(
        words, cwd=folder, env=dict(os.environ), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    assert run.stderr is not None
    errors: list[str] = []
    display(0)
    try:
        for line in run.stderr:
            errors.append(line)
            display.show_position(line.strip())
        return run.wait(), "".join(errors)
    except BaseException:  # Ctrl-C: the launcher ends its ranks within a second
        run.terminate()
        run.wait()
        raise
    finally:
        display.close()


def _run_failure_exception(launcher: str, status: int, errors: str, is_file_created: bool) -> Exception:
    """Exception for a run that the command `launcher` started and that did not complete. status, errors: exit
    status and standard error of the run. is_file_created: whether the ranks had created the result file."""
    lines = [line for line in errors.splitlines() if line.startswith("rodsweep: ")]
    if lines:
        return EXCEPTION_OF_EXIT_STATUS.get(status, RuntimeError)(lines[0].removeprefix("rodsweep: "))
    if is_file_created or "Traceback" in errors:
        return RuntimeError(errors[-MAX_QUOTED_STDERR_LENGTH:])
    output = " ".join(errors.split()) or f"exit status {status}"
    return EnvironmentIncomplete(f"{launcher} did not start the ranks: {output[-MAX_QUOTED_STDERR_LENGTH:]}")


def _mpiexec_path() -> str:
    """Path of mpiexec in the folder of this Python, else on the search path; EnvironmentIncomplete if mpiexec
    is not found."""
    next_to_python = shutil.which("mpiexec", path=str(Path(sys.executable).parent))
    path = next_to_python or shutil.which("mpiexec")
    if path is None:
        message = "mpiexec, which starts the ranks, is not found; `make install` provides it"
        raise EnvironmentIncomplete(message)
    return path
