"""The command `rodsweep` in forked children of one process that has everything loaded already.

A run takes milliseconds instead of a start-up, and one that hangs, takes too much memory or crashes
natively ends only its own child. Requests come as lines of JSON on standard input and are answered by
lines on standard output, one each; `faults.isolated` is the other end. `test_start.py` holds what comes
of it against the command that is started afresh.
"""

import io
import json
import os
import resource
import select
import signal
import sys
import traceback
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

SOLVERS = ("petsc4py", "slepc4py")
UNCAUGHT = 70
"""Exit status of a child that an exception ended: the interpreter's own, 1, has a meaning."""


class NoSolver:
    """Refuses to import a solver: bad input must never come so far."""

    def find_spec(self, name: str, path: object = None, target: object = None) -> None:
        if name.partition(".")[0] in SOLVERS:
            raise AssertionError(f"{name} is imported although nothing is to be solved")


def child(request: dict) -> NoReturn:
    """Runs the command in this process, which it ends."""
    for stream, name in ((1, "stdout"), (2, "stderr")):
        os.dup2(os.open(request[name], os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), stream)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    code = UNCAUGHT
    try:
        os.chdir(request["directory"])
        os.environ.update(request["environment"])
        limit_resources(request["seconds"], request["memory"])
        request["words"] = [os.fsdecode(bytes.fromhex(word)) for word in request["words"]]
        if request["call"] == "content":
            print(json.dumps(content(Path(request["words"][0]))))
            code = 0
        else:
            die_after(request["points"])
            sys.argv = ["rodsweep", *request["words"]]
            exec(request["patch"], {"__name__": "sitecustomize"})
            from rodsweep.cli import main

            main()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 0
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def limit_resources(seconds: int | None, memory: int | None) -> None:
    """Lets this process take so many seconds of the processor, and so many bytes more than it has."""
    taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if memory is not None:
        resource.setrlimit(resource.RLIMIT_AS, (taken + memory, taken + memory))
    if seconds is not None:
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))


def content(path: Path) -> dict:
    """Every variable of a file but the time it took: its type, shape and bytes."""
    import h5py

    with h5py.File(path) as file:
        names = (name for name in file if name != "seconds" and not name.startswith("user_"))
        variables = {name: file.get(name) for name in names}
        values = {name: data[...] for name, data in variables.items()}
    return {name: [v.dtype.str, list(v.shape), v.tobytes().hex()] for name, v in values.items()}


def die_after(points: int | None) -> None:
    """Lets the run be killed once it has finished so many points."""
    from rodsweep.results.run.journal import Journal

    append, done = Journal.append, []

    def append_and_die(self: Journal, index: int, values: dict) -> None:
        append(self, index, values)
        done.append(index)
        if len(done) == points:
            os.kill(os.getpid(), signal.SIGKILL)

    if points is not None:
        Journal.append = append_and_die


def answer(request: dict) -> dict:
    """How a child ended: its exit status, negative for a signal, and whether it took too long."""
    pid = os.fork()
    if not pid:
        child(request)
    handle = os.pidfd_open(pid)
    waits = not select.select([handle], [], [], request["patience"])[0]
    if waits:
        os.kill(pid, signal.SIGKILL)
    os.close(handle)
    status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    return {"status": status, "slow": waits or status == -signal.SIGXCPU}


def load(solving: bool, configs: list[str]) -> None:
    """Imports everything and compiles what is compiled at first use for some configs."""
    import rodsweep.cli.checking
    import rodsweep.cli.running
    import rodsweep.post.figures
    import rodsweep.post.summary  # noqa: F401
    from rodsweep.errors import EnvironmentLacks
    from rodsweep.sweep.team import Team
    from rodsweep.tasks.job import make_job

    for path in configs:
        job = make_job(Path(path), ())
        job.task.cost()
        if solving:
            Team()
            with suppress(EnvironmentLacks):
                job.task.solver().warm_up()
    if solving:
        draw()
    else:
        sys.meta_path.insert(0, NoSolver())


def draw() -> None:
    """Draws a figure of all that figures have, so that no child loads fonts and what reads formulas."""
    from matplotlib.figure import Figure

    figure = Figure(layout="constrained")
    axes = figure.subplots()
    axes.loglog([1, 1e3], [1, 1e3], label=r"$\tilde k_1 = 10^{4}$")
    axes.set_title(r"$1.5\times10^{-3}$, a word")
    figure.legend()
    figure.savefig(io.BytesIO(), dpi=300)


def main() -> None:
    load(sys.argv[1] == "solving", sys.argv[2:])
    requests = sys.stdin.buffer
    with open(os.dup(1), "w", encoding="utf-8") as answers:
        os.dup2(2, 1)
        print("{}", file=answers, flush=True)
        for line in requests:
            print(json.dumps(answer(json.loads(line))), file=answers, flush=True)


if __name__ == "__main__":
    main()
