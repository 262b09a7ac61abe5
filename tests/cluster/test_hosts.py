"""A sweep over two hosts that have only TCP between them: network namespaces with a cable."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import BIN
from contents import content, same, same_spectra
from kernels import other_kernels
from ranks import PATIENCE
from surveyed import survey_only

from rodsweep.results.file.view import read_view

SPECTRA = """
task: spectrum
parameters:
  F: {start: 0, stop: 60, num: 200}
  k1: [100, 1.0e4, .inf]
  k2: [50, 1.0e4]
  gamma3: [0, 1.0e-4]
"""
CYCLES = "task: limit_cycle\nparameters: {points: points.csv}\naccuracy: 1.0e-6\n"
BOTH_BEGIN = f"""
import pathlib, time
from dataclasses import replace
import rodsweep.sweep.loop as loop

real = loop.sweep

def sweep(ranks, todo, work, *words):
    own, other = (pathlib.Path(f"begun-{{rank}}") for rank in (ranks.rank, 1 - ranks.rank))

    def solve(unit):
        own.touch()
        end = time.monotonic() + {PATIENCE / 2}
        while not other.exists() and time.monotonic() < end:
            time.sleep(0.01)
        return work.solve(unit)

    return real(ranks, todo, replace(work, solve=solve), *words)

loop.sweep = sweep
"""
"""A sitecustomize.py: the first solve of each rank lasts until the other has begun one, or a while."""
FIRST_RANK_INSIDE = f"""
import os, pathlib, time
from dataclasses import replace
import rodsweep.sweep.loop as loop

real, inside, elsewhere = loop.sweep, pathlib.Path("inside"), pathlib.Path("elsewhere")
elsewhere.touch()

def wait(reached):
    end = time.monotonic() + {PATIENCE / 2}
    while not reached() and time.monotonic() < end:
        time.sleep(0.01)

def sweep(ranks, todo, work, *words):
    solve = work.solve

    def solve_long(index):
        if not inside.exists():
            inside.touch()
            wait(lambda: elsewhere.stat().st_size > 14)
        return solve(index)

    def solve_elsewhere(index):
        with elsewhere.open("ab") as solved:
            solved.write(b".")
        return solve(index)

    if not ranks.is_first:
        wait(inside.exists)
    own = solve_long if ranks.is_first else solve_elsewhere
    return real(ranks, todo, replace(work, solve=own), *words)

loop.sweep = sweep
"""
"""A sitecustomize.py: the first solve of the first rank lasts until the other has begun 15, or a while."""


BLAS = {name: value for name, value in os.environ.items() if name.startswith(("OPENBLAS_", "MKL_", "BLIS_"))}
"""What chooses the kernel of the BLAS here, which the other host does not hear of by itself."""

PYTHONPATH = os.environ.get("PYTHONPATH", "")


class TwoHosts:
    """`rodsweep` on two hosts, a rank on each."""

    def __init__(self, command, unshare: list[str]):
        self.command = command
        self.words = [*unshare, "bash", str(Path(__file__).with_name("two_hosts.sh"))]

    def run(
        self, *words: object, here: dict[str, str] | None = None, **variables: str
    ) -> subprocess.CompletedProcess:
        """A run of the command with the given variables on both hosts, and others on the first only."""
        variables.setdefault("PYTHONPATH", PYTHONPATH)
        launcher, *rest = self.command.argv(*words, ranks=2)
        passed = [word for name in variables for word in ("-x", name)]
        foreign = ("SLURM", "OMPI_", "PMIX_")  # tests may themselves run inside a job, or beside ranks
        return subprocess.run(
            [*self.words, launcher, "--host", "10.0.0.1,10.0.0.2", *passed, *rest],
            cwd=self.command.directory,
            env={n: v for n, v in os.environ.items() if not n.startswith(foreign)} | variables | (here or {}),
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )


@pytest.fixture
def hosts(command):
    """Two hosts, as root or as an ordinary user who may have user namespaces."""
    launcher = subprocess.run([BIN / "mpiexec", "--version"], capture_output=True, text=True, check=False)
    if "(Open" not in launcher.stdout:
        pytest.skip("no two hosts here: only for the mpiexec of Open MPI is known how it reaches the other")
    # Whoever ends early, this process or `unshare`, takes all others with it.
    unshare = ["setpriv", "--pdeathsig", "KILL", "unshare", "--pid", "--fork", "--kill-child", "--mount-proc"]
    unshare += ["--net", "--uts"]
    if os.geteuid():
        unshare += ["--user", "--map-root-user"]
    hosts = TwoHosts(command, unshare)
    try:
        tried = subprocess.run([*hosts.words, "true"], capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        pytest.skip(f"no two hosts here: {error}")
    if tried.returncode:
        pytest.skip(f"no two hosts here: {tried.stderr.strip().splitlines()[-1]}")
    return hosts


def test_sweep_over_two_hosts_gives_the_content_of_a_plain_run(hosts, command):
    """To the last bit, for both hosts are told to use the same BLAS kernel.

    Each waits in its first solve for the other, so that both take part however late one comes.
    """
    command.write("c.yaml", SPECTRA)
    command.write("sitecustomize.py", BOTH_BEGIN)
    run = hosts.run("run", "c.yaml", PYTHONPATH=f".{os.pathsep}{PYTHONPATH}", **BLAS)
    assert run.returncode == 0, run.stderr
    attributes = read_view(command.directory / "c.h5").attributes
    assert attributes["hosts"].split() == ["host-a", "host-b"]
    points = attributes["rank_points"]
    assert points.sum() == 2400
    assert points.min() > 0
    assert len(attributes["blas_kernels"].splitlines()) == 1
    assert "BLAS kernels" not in run.stdout
    assert command("run", "c.yaml", "-o", "plain.h5").returncode == 0
    assert same(content(command.directory / "c.h5"), content(command.directory / "plain.h5"))


@survey_only
def test_hosts_with_different_blas_kernels_agree_within_their_error_estimates(hosts, command):
    """The other host takes the kernel of its processor, as a rank that is started by ssh does."""
    plain = {name: value for name, value in os.environ.items() if name not in BLAS}
    others = other_kernels(environment=plain, most=1)
    if not others:
        pytest.skip("this BLAS has no other kernel to choose here")
    command.write("c.yaml", SPECTRA)
    command.write("sitecustomize.py", BOTH_BEGIN)
    path = f".{os.pathsep}{PYTHONPATH}"
    run = hosts.run("run", "c.yaml", here={"OPENBLAS_CORETYPE": next(iter(others))}, PYTHONPATH=path)
    assert run.returncode == 0, run.stderr
    assert run.stdout.count("computed in parts by 2 BLAS kernels") == 1
    assert next(iter(others.values())) in read_view(command.directory / "c.h5").attributes["blas_kernels"]
    assert command("run", "c.yaml", "-o", "plain.h5").returncode == 0
    assert same_spectra(content(command.directory / "c.h5"), content(command.directory / "plain.h5"))


@pytest.mark.long
def test_other_host_need_not_wait_while_the_first_rank_is_inside_a_long_solve(hosts, command):
    """The first point lasts until the other rank has begun 15; if it waited, it would share them."""
    rows = [f"{F},1e4,100,1e-2,1\n" for F in np.linspace(1, 20, 20)]
    command.write("points.csv", "F,k1,k2,gamma3,gamma1\n" + "".join(rows))
    command.write("c.yaml", CYCLES)
    command.write("sitecustomize.py", FIRST_RANK_INSIDE)
    run = hosts.run("run", "c.yaml", PYTHONPATH=f".{os.pathsep}{PYTHONPATH}", **BLAS)
    assert run.returncode == 0, run.stderr
    points = read_view(command.directory / "c.h5").attributes["rank_points"]
    assert points.sum() == 20
    assert points[1] > 14, points
    assert command("run", "c.yaml", "-o", "plain.h5").returncode == 0
    assert same(content(command.directory / "c.h5"), content(command.directory / "plain.h5"))
