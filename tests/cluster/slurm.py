"""A Slurm of one's own: munged, slurmctld and three slurmd on the loopback address.

It runs as whoever runs the tests. As root each slurmd gets a host name of its own, so that MPI takes the
nodes for different machines.
"""

import os
import pwd
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TypeVar

from ranks import PATIENCE

T = TypeVar("T")

NODES = ("n1", "n2", "n3")
COMING_UP = 60.0
"""Seconds in which the daemons have to come up, which takes one or two, and more on a busy machine."""
PAUSE = 0.3
"""Seconds between two questions: each is a process of its own, and jobs take seconds."""
ENDED = {"COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL", "BOOT_FAIL", "OUT_OF_MEMORY"}

CONFIGURATION = """\
ClusterName=tests
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
# A requeued job starts again when its credential is over; 5 seconds is the least there is.
AuthInfo=socket={directory}/munge.socket,cred_expire=5
StateSaveLocation={directory}
SlurmdSpoolDir={directory}/%n
SlurmctldPidFile={directory}/slurmctld.pid
SlurmdPidFile={directory}/%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0
SlurmdParameters=config_overrides
ReturnToService=2
JobRequeue=0
MailProg=/bin/true
{nodes}
PartitionName=tests Nodes=ALL Default=YES MaxTime=INFINITE
"""


class CannotStart(Exception):
    """Slurm does not start on this machine; the text says why."""


class Slurm:
    """A running Slurm; its commands are given in one directory, by default where jobs start and write."""

    def __init__(self, environment: dict[str, str], own_host_names: bool):
        self.environment, self.own_host_names = environment, own_host_names
        self.directory = Path.cwd()

    def __call__(self, *words: object) -> str:
        """What a command of Slurm prints."""
        run = self._run(words)
        assert run.returncode == 0, f"{words}: {run.stderr}"
        return run.stdout.strip()

    def refuses(self, *words: object) -> str:
        """What a command of Slurm that fails says last; nothing where it succeeds."""
        run = self._run(words)
        return (run.stderr.splitlines() or ["(nothing)"])[-1] if run.returncode else ""

    def _run(self, words: tuple[object, ...]) -> "subprocess.CompletedProcess[str]":
        return subprocess.run(
            [*map(str, words)],
            cwd=self.directory,
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )

    def submit(self, *words: object) -> str:
        """Submits a job; returns its number."""
        return self("sbatch", "--parsable", *words)

    def about(self, job: str, field: str) -> str:
        """What `scontrol show job` says in a field."""
        words = self("scontrol", "show", "job", "-o", job).split()
        return next(word.removeprefix(f"{field}=") for word in words if word.startswith(f"{field}="))

    def warn(self, job: str) -> None:
        """Does at once what Slurm does before the time is up, for `--signal=B:USR1`."""
        self("scancel", "--batch", "--signal=USR1", job)

    def cancel_all(self) -> None:
        """Cancels what is left and waits until it is gone: slurmd does not end its jobs when it is ended."""
        self("scancel", "--user", os.geteuid())
        wait_for(lambda: not self("squeue", "--noheader"), "the last job to go")

    def idle(self) -> bool:
        """Whether all nodes are up and have nothing to do."""
        words = ("timeout", "5", "sinfo", "--noheader", "--Node", "--format=%T")
        run = subprocess.run(words, env=self.environment, capture_output=True, text=True, check=False)
        return run.stdout.split() == ["idle"] * len(NODES)

    def end(self, job: str) -> str:
        """Waits for the end of a job; returns its state, and its exit status: "COMPLETED 0:0"."""
        wait_for(lambda: self.about(job, "JobState") in ENDED, f"the end of job {job}")
        return f"{self.about(job, 'JobState')} {self.about(job, 'ExitCode')}"


def wait_for(condition: Callable[[], T], what: str) -> T:
    """Waits until the condition holds; returns what it then gave."""
    deadline = time.monotonic() + PATIENCE
    while not (value := condition()):
        assert time.monotonic() < deadline, f"waited {PATIENCE:g} s for {what}"
        time.sleep(PAUSE)
    return value


@contextmanager
def started_slurm() -> Iterator[Slurm]:
    """Slurm for as long as the context lasts; CannotStart where it is not installed or does not come up."""
    programs = _programs("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "setpriv")
    with ExitStack() as stack:
        directory = Path(tempfile.mkdtemp(prefix="slurm-"))
        stack.callback(shutil.rmtree, directory, ignore_errors=True)
        directory.chmod(0o755)  # munged wants its socket where everybody can reach it
        own_host_names = os.geteuid() == 0 and _can("unshare", "--uts", "true")
        environment = _configure(directory, own_host_names)
        daemons = stack.enter_context(_Daemons(directory, environment))

        key, socket_ = directory / "munge.key", directory / "munge.socket"
        key.touch(0o600)
        key.write_bytes(os.urandom(128))
        files = [f"--{what}-file={directory}/munge.{what}" for what in ("key", "pid", "log", "seed")]
        daemons.start(programs["munged"], "--foreground", "--force", f"--socket={socket_}", *files)
        daemons.until(socket_.exists)
        daemons.start(programs["slurmctld"], "-D")
        for node in NODES:
            # As root it has a host name of its own.
            host = ["unshare", "--uts", "sh", "-c", 'hostname "$0" && exec "$@"', node]
            daemons.start(*host[: None if own_host_names else 0], programs["slurmd"], "-D", "-N", node)
        slurm = Slurm(environment, own_host_names)
        daemons.until(slurm.idle)
        stack.callback(slurm.cancel_all)
        yield slurm


def _programs(*names: str) -> dict[str, str]:
    """Where the programs are; CannotStart if some are not installed."""
    path = f"{os.environ['PATH']}:/usr/sbin:/sbin"
    found = {name: shutil.which(name, path=path) or "" for name in names}
    if missing := [name for name in names if not found[name]]:
        raise CannotStart(f"{', '.join(missing)} not installed (on Debian: apt install slurm-wlm munge)")
    return found


def _can(*words: str) -> bool:
    """Whether a command succeeds."""
    return subprocess.run(words, capture_output=True, check=False).returncode == 0


def _configure(directory: Path, own_host_names: bool) -> dict[str, str]:
    """Writes slurm.conf; returns the environment in which commands find it, and in which jobs run."""
    host = socket.gethostname().split(".")[0]
    with ExitStack() as stack:
        free = [stack.enter_context(socket.socket()) for _ in range(1 + len(NODES))]
        for each in free:
            each.bind(("127.0.0.1", 0))
        port, *ports = [each.getsockname()[1] for each in free]
    hosts = NODES if own_host_names else [host] * len(NODES)
    nodes = "\n".join(
        f"NodeName={node} NodeHostname={its_host} NodeAddr=127.0.0.1 Port={its_port} CPUs=4"
        for node, its_host, its_port in zip(NODES, hosts, ports, strict=True)
    )
    try:
        user = pwd.getpwuid(os.geteuid()).pw_name
    except KeyError:
        raise CannotStart(f"user {os.geteuid()} has no name") from None
    path = directory / "slurm.conf"
    path.write_text(CONFIGURATION.format(directory=directory, host=host, port=port, nodes=nodes, user=user))
    foreign = ("SLURM", "SBATCH", "OMPI_", "PMIX_")  # tests may themselves run inside a job, or beside ranks
    kept = {name: value for name, value in os.environ.items() if not name.startswith(foreign)}
    # The nodes have the same addresses, and Open MPI 5 finds no way from an IPv6 address to itself.
    environment = kept | {"SLURM_CONF": str(path), "OMPI_MCA_btl_tcp_disable_family": "6"}
    version = subprocess.run(
        ["sbatch", "--version"], env=environment, capture_output=True, text=True, check=True
    )
    if int(version.stdout.split()[1].split(".")[0]) >= 23:  # before, it does without control groups by itself
        (directory / "cgroup.conf").write_text("CgroupPlugin=disabled\n")
    return environment


class _Daemons:
    """Processes that are ended, the last first, at the end of the context; they write into logs."""

    def __init__(self, directory: Path, environment: dict[str, str]):
        self.directory, self.environment = directory, environment
        self.running: list[subprocess.Popen[bytes]] = []

    def __enter__(self) -> "_Daemons":
        return self

    def start(self, *words: str) -> None:
        with self._log(len(self.running)).open("w") as log:
            process = subprocess.Popen(
                ["setpriv", "--pdeathsig", "TERM", *words],  # should this process die, it ends too
                env=self.environment,
                cwd=self.directory,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=log,
            )
        self.running.append(process)

    def until(self, condition: Callable[[], bool]) -> None:
        """Waits for the condition; CannotStart, with what the logs end with, if it does not come to hold."""
        deadline = time.monotonic() + COMING_UP
        while not condition():
            ended = [number for number, process in enumerate(self.running) if process.poll() is not None]
            if ended:
                raise CannotStart(f"a daemon ended at once: {self._last_words(ended[0])}")
            if time.monotonic() > deadline:
                words = " | ".join(map(self._last_words, range(len(self.running))))
                raise CannotStart(f"its daemons are not ready after {COMING_UP:g} s: {words}")
            time.sleep(0.05)

    def _log(self, number: int) -> Path:
        return self.directory / f"daemon-{number}.log"

    def _last_words(self, number: int) -> str:
        return (self._log(number).read_text(errors="replace").splitlines() or ["(nothing)"])[-1]

    def __exit__(self, *_: object) -> None:
        for process in reversed(self.running):
            process.terminate()
            try:
                process.wait(5)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
