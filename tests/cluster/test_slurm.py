"""The scripts in jobs/ under a real Slurm: submitted, cancelled, requeued, out of time; the same content."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import BIN, RANK, ROOT, Command
from contents import content, same
from faults.isolated import Isolated
from ranks import PATIENCE
from slow_runs import FOR_EVER, slowly

from rodsweep.results.file.view import read_view
from rodsweep.results.layouts.variables import MISSING_STATUS

from .slurm import CannotStart, Slurm, started_slurm, wait_for

CONFIG = """
task: spectrum
parameters:
  F: {start: 0, stop: 60, num: 9}
  k1: [100, 1.0e4, .inf]
  k2: [50, 1.0e4]
  gamma3: [0, 1.0e-4]
spectrum: {modes: 4, follow: false}
"""

SLOWLY = f"""
import os

if (
    "HALT" in os.environ
    and "SLURM_RESTART_COUNT" not in os.environ
    and os.environ.get("SLURM_ARRAY_TASK_ID", "2") == "2"
):
    exec({slowly(FOR_EVER, points=15)!r})
with open(f"threads-{{os.getpid()}}", "w") as threads:
    threads.write(f"{{os.environ['OMP_NUM_THREADS']}} thread on {{len(os.sched_getaffinity(0))}} core")
"""
"""A sitecustomize.py that, with HALT, lets every rank wait after 15 points until it is asked to stop, of an
array those of the second shard; not once the job was requeued. It notes where a rank may run."""

STOPPED = "kept, the same command continues"


@pytest.fixture(scope="module")
def running():
    """Slurm, for all tests of this module."""
    try:
        with started_slurm() as slurm:
            yield slurm
    except CannotStart as reason:
        pytest.skip(f"no Slurm here: {reason}")


@pytest.fixture(scope="module")
def expected(tmp_path_factory, loaded):
    """The content that a plain run gives."""
    plain = Command(tmp_path_factory.mktemp("plain"), lambda: loaded)
    plain.write("c.yaml", CONFIG)
    assert plain("run", "c.yaml").returncode == 0
    return content(plain.directory / "c.h5")


@pytest.fixture(scope="module")
def out_of_time(running, tmp_path_factory):
    """(directory, number) of a job that will run out of time: it is let run while other tests do.

    Slurm looks twice a minute who is to be warned; two minutes before the end is 30 to 60 s from now.
    """
    running.directory = clone_in(tmp_path_factory.mktemp("out_of_time"))
    words = ("--time=00:03:00", "--nodelist=n3", halted(running))
    return running.directory, running.submit(*words, "jobs/one_node.sh", "c.yaml", "c.h5")


@pytest.fixture
def slurm(running, out_of_time, tmp_path):
    """Slurm whose jobs are submitted from a directory that looks like the clone and holds a config."""
    running.directory = clone_in(tmp_path)
    return running


@pytest.fixture
def quick_slurm(running, out_of_time, tmp_path, loaded):
    """The same, with ranks forked from a loaded process: for what depends on jobs, not on their start."""
    running.directory = clone_in(tmp_path)
    fork_ranks(tmp_path, loaded)
    return running


def clone_in(directory: Path) -> Path:
    (directory / ".venv").mkdir()
    (directory / ".venv" / "bin").symlink_to(BIN)
    (directory / "jobs").symlink_to(ROOT / "jobs")
    (directory / "c.yaml").write_text(CONFIG)
    (directory / "patch").mkdir()
    (directory / "patch" / "sitecustomize.py").write_text(SLOWLY)
    return directory


def fork_ranks(clone: Path, loaded: Isolated) -> None:
    """Lets the command of a clone be forked from a loaded process."""
    own = clone / ".venv" / "bin"
    own.unlink()
    own.mkdir()
    (own / "mpiexec").symlink_to(BIN / "mpiexec")
    (own / "rodsweep").write_text(f'#!/bin/sh\nexec {sys.executable} -SE {RANK} {loaded.ranks} "$@"\n')
    (own / "rodsweep").chmod(0o755)


def halted(slurm: Slurm, *more: str) -> str:
    """The option of sbatch with which a job waits until it is warned, cancelled or requeued."""
    path = f"PYTHONPATH={slurm.directory / 'patch'}:{ROOT}"
    return ",".join(["--export=ALL", "HALT=1", path, *(more or ["OMP_NUM_THREADS=8"])])


def until_some_are_done(result: Path) -> None:
    """Waits until the journal of a result file holds some points."""

    def growing() -> bool:
        pages = result.with_name(f"{result.name}.journal").glob("rank-*")
        return sum(page.stat().st_size for page in pages) > 1000

    wait_for(growing, f"points in the journal of {result}")


def log(slurm: Slurm) -> str:
    return "".join(path.read_text() for path in sorted(slurm.directory.glob("rodsweep*.log")))


@pytest.mark.long
def test_script_hands_the_warning_on_and_asks_for_a_requeue(tmp_path, loaded):
    """Without Slurm: what the script does in it, with a `scontrol` that only notes how it is called."""
    clone_in(tmp_path)
    fork_ranks(tmp_path, loaded)
    (tmp_path / "scontrol").write_text('#!/bin/sh\necho "$@" > asked\n')
    (tmp_path / "scontrol").chmod(0o755)
    variables = {"SLURM_SUBMIT_DIR": str(tmp_path), "SLURM_NTASKS": "2", "SLURM_JOB_ID": "7"}
    variables |= {"PATH": f"{tmp_path}:{os.environ['PATH']}"}
    words = ["bash", str(ROOT / "jobs" / "one_node.sh"), "c.yaml"]
    warned = subprocess.Popen(
        words,
        cwd="/",
        env=os.environ | variables | {"HALT": "1", "PYTHONPATH": f"{tmp_path / 'patch'}:{ROOT}"},
    )
    until_some_are_done(tmp_path / "results" / "c.h5")
    warned.send_signal(signal.SIGUSR1)
    assert warned.wait(PATIENCE) == 75
    assert (tmp_path / "asked").read_text() == "requeue 7\n"
    again = subprocess.run(words, cwd="/", env=os.environ | variables, check=False, timeout=PATIENCE)
    assert again.returncode == 0
    assert read_view(tmp_path / "results" / "c.h5").attributes["ranks"] == 2


def test_job_gives_the_content_of_a_plain_run_and_submitted_again_has_nothing_to_do(slurm, expected):
    for said in ("108 of 108 points to do", "c.h5 is complete, nothing to do"):
        job = slurm.submit("jobs/one_node.sh", "c.yaml", "c.h5")
        assert slurm.end(job) == "COMPLETED 0:0", log(slurm)
        assert said in (slurm.directory / f"rodsweep-{job}.log").read_text()
    assert same(content(slurm.directory / "c.h5"), expected)
    assert read_view(slurm.directory / "c.h5").attributes["ranks"] == 2


def test_job_cancelled_in_the_middle_continues_when_submitted_again(quick_slurm, expected):
    job = quick_slurm.submit(halted(quick_slurm), "jobs/one_node.sh", "c.yaml", "c.h5")
    until_some_are_done(quick_slurm.directory / "c.h5")
    quick_slurm("scancel", job)
    assert quick_slurm.end(job).startswith("CANCELLED")
    assert quick_slurm.about(job, "Restarts") == "0"
    again = quick_slurm.submit("jobs/one_node.sh", "c.yaml", "c.h5")
    assert quick_slurm.end(again) == "COMPLETED 0:0", log(quick_slurm)
    assert " kept" in (quick_slurm.directory / f"rodsweep-{again}.log").read_text()
    assert same(content(quick_slurm.directory / "c.h5"), expected)


def test_job_requeued_in_the_middle_finishes_by_itself(quick_slurm, expected):
    job = quick_slurm.submit(halted(quick_slurm), "jobs/one_node.sh", "c.yaml", "c.h5")
    until_some_are_done(quick_slurm.directory / "c.h5")
    quick_slurm("scontrol", "requeue", job)
    assert quick_slurm.end(job) == "COMPLETED 0:0", log(quick_slurm)
    assert quick_slurm.about(job, "Restarts") == "1"
    assert log(quick_slurm).count("108 points to do") == 2  # the log of both times
    assert log(quick_slurm).count(" kept") == 1
    assert same(content(quick_slurm.directory / "c.h5"), expected)


@pytest.mark.long
def test_job_on_many_nodes_is_warned_on_all_of_them(slurm, expected):
    words = ("--nodes=2", "--nodelist=n1,n2", "--ntasks-per-node=1", halted(slurm))
    job = slurm.submit(*words, "jobs/many_nodes.sh", "c.yaml", "c.h5")
    until_some_are_done(slurm.directory / "c.h5")
    slurm.warn(job)
    assert slurm.end(job) == "COMPLETED 0:0", log(slurm)
    assert log(slurm).count(STOPPED) == 1
    assert same(content(slurm.directory / "c.h5"), expected)
    assert read_view(slurm.directory / "c.h5").attributes["ranks"] == 2
    notes = [path.read_text() for path in slurm.directory.glob("threads-*")]
    assert notes == ["1 thread on 1 core"] * 4  # two ranks, twice
    if slurm.own_host_names:
        assert read_view(slurm.directory / "c.h5").attributes["hosts"].split() == ["n1", "n2"]


def test_shards_of_an_array_are_merged_when_all_have_ended(quick_slurm, expected):
    array = quick_slurm.submit("--array=1-3", halted(quick_slurm), "jobs/shards.sh", "c.yaml", "c.h5")
    last = quick_slurm.submit(f"--dependency=afterok:{array}", "jobs/merge.sh", "c.yaml", "c.h5")
    until_some_are_done(quick_slurm.directory / "c-2-of-3.h5")
    quick_slurm.warn(f"{array}_2")
    assert quick_slurm.end(last) == "COMPLETED 0:0", log(quick_slurm)
    assert log(quick_slurm).count(STOPPED) == 1
    assert "108 points from 3 files, 0 missing" in log(quick_slurm)
    parts = [content(path)["status"] for path in quick_slurm.directory.glob("c-*-of-3.h5")]
    assert [(part != MISSING_STATUS).sum() for part in parts] == [36, 36, 36]
    assert same(content(quick_slurm.directory / "c.h5"), expected)


def test_shard_with_a_failed_point_does_not_hold_up_the_merge(quick_slurm):
    """The onset F* cannot be had to 1e-12, so one shard exits with 1, and so does the merge."""
    config = "task: spectrum\nparameters: {F: [10, 20.0080206921031], k1: 1e4, k2: 1e4, gamma3: 1e-4}\n"
    (quick_slurm.directory / "c.yaml").write_text(config + "accuracy: 1e-12\n")
    array = quick_slurm.submit("--array=1-2", "jobs/shards.sh", "c.yaml", "c.h5")
    last = quick_slurm.submit(f"--dependency=afterok:{array}", "jobs/merge.sh", "c.yaml", "c.h5")
    assert quick_slurm.end(last) == "FAILED 1:0", log(quick_slurm)
    assert "c.h5: 1 ok, 1 accuracy_not_reached" in log(quick_slurm)


def test_job_that_may_not_be_requeued_says_so_and_exits_with_75(quick_slurm):
    job = quick_slurm.submit("--no-requeue", halted(quick_slurm), "jobs/one_node.sh", "c.yaml", "c.h5")
    until_some_are_done(quick_slurm.directory / "c.h5")
    quick_slurm.warn(job)
    assert quick_slurm.end(job) == "FAILED 75:0", log(quick_slurm)
    assert "may not be requeued: submit it again to continue" in log(quick_slurm)


def test_job_with_a_bad_config_fails_and_is_not_repeated(quick_slurm):
    (quick_slurm.directory / "c.yaml").write_text(CONFIG.replace("modes", "mods"))
    job = quick_slurm.submit("jobs/one_node.sh", "c.yaml", "c.h5")
    assert quick_slurm.end(job) == "FAILED 2:0", log(quick_slurm)
    assert quick_slurm.about(job, "Restarts") == "0"
    assert "did you mean modes?" in log(quick_slurm)


def test_srun_starts_the_ranks_where_it_can(slurm, expected):
    if reason := slurm.refuses("srun", "--ntasks=1", "--mpi=pmix", "true"):
        pytest.skip(f"this Slurm cannot load PMIx (on Debian: apt install libpmix-dev): {reason}")
    words = (halted(slurm, "LAUNCH=srun --mpi=pmix"), "jobs/one_node.sh", "c.yaml", "c.h5")
    stopped = slurm.submit("--no-requeue", *words)
    until_some_are_done(slurm.directory / "c.h5")
    slurm.warn(stopped)
    assert slurm.end(stopped) == "FAILED 75:0", log(slurm)
    assert log(slurm).count(STOPPED) == 1
    again = slurm.submit(words[0].replace("HALT", "NONE"), *words[1:])
    assert slurm.end(again) == "COMPLETED 0:0", log(slurm)
    assert same(content(slurm.directory / "c.h5"), expected)
    assert read_view(slurm.directory / "c.h5").attributes["ranks"] == 2


@pytest.mark.long
def test_job_out_of_time_is_warned_and_requeues_itself(slurm, out_of_time, expected):
    slurm.directory, job = out_of_time
    assert slurm.end(job) == "COMPLETED 0:0", log(slurm)
    assert slurm.about(job, "Restarts") == "1"
    assert STOPPED in log(slurm)
    assert " kept" in log(slurm)
    assert same(content(slurm.directory / "c.h5"), expected)
