"""The command `rodsweep` in forked children of one process that has everything loaded already.

So are ranks, by a process that has started neither MPI nor PETSc: `faults.rank` hands over to it.

A run takes milliseconds instead of a start-up, and one that hangs, takes too much memory or crashes
natively ends only its own child. Requests come as lines of JSON on standard input and are answered by
lines on standard output, one each; `faults.isolated` is the other end. `test_start.py` holds what comes
of it against the command that is started afresh.
"""

import atexit
import gc
import io
import json
import os
import pickle
import resource
import select
import signal
import socket
import sys
import threading
import traceback
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO, NoReturn

SOLVERS = ("petsc4py", "slepc4py")
MEASURED = ["-m", "rodsweep.cli.measured_command"]
UNCAUGHT = 70
"""Exit status of a child that an exception ended: the interpreter's own, 1, has a meaning."""


class NoSolver:
    """Refuses to import a solver: bad input must never come so far."""

    def find_spec(self, name: str, path: object = None, target: object = None) -> None:
        if name.partition(".")[0] in SOLVERS:
            raise AssertionError(f"{name} is imported although nothing is to be solved")


def child(request: dict) -> NoReturn:
    """Runs the command in this process, which it ends."""
    write_to(request["stdout"], request["stderr"])
    code = UNCAUGHT
    try:
        os.chdir(request["directory"])
        os.environ.update(request["environment"])
        limit_resources(request["seconds"], request["memory"])
        request["words"] = decoded(request["words"])
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


def write_to(out: str, err: str) -> None:
    """Lets this process write to two files, and read nothing."""
    for stream, path in ((1, out), (2, err)):
        file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
        os.dup2(file, stream)
        os.close(file)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115


def decoded(words: list[str]) -> list[str]:
    """Words of a command as they came."""
    return [os.fsdecode(bytes.fromhex(word)) for word in words]


def several(request: dict, first: int) -> NoReturn:
    """Runs the command again and again in this process, from one of the runs on, until one run ends it.

    Each has a directory, beside which it leaves its output and last its exit status: a run without is the one
    that ended the process.
    """
    from rodsweep.cli import main

    limit_resources(None, request["memory"])
    for directory, words in request["runs"][first:]:
        place = Path(directory).parent
        write_to(f"{place}/stdout", f"{place}/stderr")
        os.chdir(directory)
        limit = int(sum(os.times()[:2]) + request["seconds"]) + 1
        resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))
        sys.argv = ["rodsweep", *decoded(words)]
        code = UNCAUGHT
        try:
            main()
            code = 0
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 0
        except BaseException:
            traceback.print_exc()
        sys.stdout.flush()
        sys.stderr.flush()
        (place / "status").write_text(str(code))
    os._exit(0)


def answer_several(request: dict) -> dict:
    """How each of several runs ended, in as few children as they leave alive."""
    ended: list[dict] = []
    places = [Path(directory).parent for directory, _ in request["runs"]]
    while len(ended) < len(places):
        one = answer(request | {"first": len(ended)})
        for place in places[len(ended) :]:
            if not (place / "status").exists():
                ended.append(one)
                break
            ended.append({"status": int((place / "status").read_text()), "slow": False})
    return {"runs": ended}


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

    def append_and_die(self: Journal, index: int, *given: Any) -> None:
        append(self, index, *given)
        done.append(index)
        if len(done) == points:
            os.kill(os.getpid(), signal.SIGKILL)

    if points is not None:
        Journal.append = append_and_die


def answer(request: dict) -> dict:
    """How a child ended: its exit status, negative for a signal, and whether it took too long."""
    pid = os.fork()
    if not pid:
        several(request, request["first"]) if "first" in request else child(request)
    handle = os.pidfd_open(pid)
    waits = not select.select([handle], [], [], request["patience"])[0]
    if waits:
        os.kill(pid, signal.SIGKILL)
    os.close(handle)
    status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    return {"status": status, "slow": waits or status == -signal.SIGXCPU}


def keep_ranks(place: str, kernels: BinaryIO) -> NoReturn:
    """Forks a child for each rank that comes to a socket, until the process that started this one ends.

    `kernels`: which compiled functions are loaded when the first rank comes, as `loaded_kernels` writes them.
    """
    parent = os.pidfd_open(os.getppid())
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(place)
        server.listen(64)
        with kernels:
            modules = kernels.read()
        if parent not in select.select([server, parent], [], [])[0]:
            load_for_ranks(modules)
            gc.freeze()
        while parent not in select.select([server, parent], [], [])[0]:
            rank, _ = server.accept()
            if not os.fork():
                server.close()
                keep_rank(rank)
            rank.close()
            with suppress(ChildProcessError):
                while os.waitpid(-1, os.WNOHANG)[0]:
                    pass
    os._exit(0)


def keep_rank(rank: socket.socket) -> None:
    """Lets a child be the rank that is at the other end, until one of them ends; returns in the child."""
    head, streams, *_ = socket.recv_fds(rank, 4, 3)
    request = json.loads(rank.recv(int.from_bytes(head, "big"), socket.MSG_WAITALL))
    pid = os.fork()
    if not pid:
        rank.close()
        raise IsRank(request, streams)
    for stream in streams:
        os.close(stream)
    rank.sendall(pid.to_bytes(4, "big"))
    handle = os.pidfd_open(pid)
    if handle not in select.select([handle, rank], [], [])[0]:
        os.kill(pid, signal.SIGKILL)
    status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    with suppress(OSError):
        rank.sendall(status.to_bytes(4, "big", signed=True))
    os._exit(0)


class IsRank(Exception):
    """This process is a rank: what was requested of it, and its streams."""

    def __init__(self, request: dict, streams: list[int]):
        self.request, self.streams = request, streams


def be_rank(request: dict, streams: list[int]) -> None:
    """Runs the command as one rank, in this process, which ends as any other does: MPI wants that.

    Or as the benchmark of the sweep starts it, see `rodsweep.cli.measured_command`.
    """
    for stream, given in enumerate(streams):
        os.dup2(given, stream)
        os.close(given)
    sys.stderr = open(2, "w", 1, "utf-8", "backslashreplace", closefd=False)  # noqa: SIM115
    sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    os.chdir(request["directory"])
    os.environ.clear()
    os.environ.update(request["environment"])
    sys.argv = ["rodsweep", *request["words"]]
    patch = Path("patch/sitecustomize.py")
    if str(patch.parent.absolute()) in os.environ.get("PYTHONPATH", ""):
        exec(patch.read_text(), {"__name__": "sitecustomize"})
    if request["words"][:2] == MEASURED:
        from rodsweep.cli.measured_command import run_and_record_memory as main

        sys.argv = request["words"][1:]
    else:
        from rodsweep.cli import main
    end_as(main)


def end_as(main: Callable[[], object]) -> NoReturn:
    """Ends this process as Python ends one after `main`, but leaves all that is loaded to the system.

    Python would take it down module by module, which takes 0.2 s. PETSc and MPI, which end last of all,
    end in the order in which Python ends them.
    """
    code: object = 0
    try:
        main()
    except SystemExit as end:
        code = end.code or 0
    except BaseException:
        sys.excepthook(*sys.exc_info())
        code = 1
    if not isinstance(code, int):
        print(code, file=sys.stderr)
        code = 1
    threading._shutdown()  # waits for threads that are no daemons
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError):
            stream.flush()
    for name in ("slepc4py.SLEPc", "petsc4py.PETSc"):
        if library := sys.modules.get(name):
            library._finalize()
    mpi = sys.modules.get("mpi4py.MPI")
    if mpi and mpi.Is_initialized() and not mpi.Is_finalized():
        mpi.Finalize()
    os._exit(code)


def import_all() -> None:
    """Imports what all runs need and what starts neither MPI nor PETSc."""
    import email.parser  # noqa: F401
    import encodings.ascii  # noqa: F401

    import rich._emoji_codes  # noqa: F401
    import scipy

    import rodsweep.cli.checking
    import rodsweep.cli.run.running
    import rodsweep.post.figures
    import rodsweep.post.summary
    import rodsweep.tasks.cycle_shapes  # noqa: F401
    from rodsweep.model.units import unit_registry

    for name in ("interpolate", "ndimage", "spatial"):
        getattr(scipy, name)
    unit_registry()


def load(solving: bool, configs: list[str]) -> None:
    """Compiles what is compiled at first use for some configs, after `import_all`."""
    from rodsweep.errors import EnvironmentIncomplete
    from rodsweep.sweep.ranks import Ranks
    from rodsweep.tasks.running.job import job_of_file

    for path in configs:
        job = job_of_file(Path(path), ())
        job.task.cost()
        if solving:
            Ranks()
            with suppress(EnvironmentIncomplete):
                job.task.solver().warm_up()
    find_provenance(solving)
    if solving:
        load_changes()
        load_arms()
        draw()
    else:
        sys.meta_path.insert(0, NoSolver())


def load_changes() -> None:
    """Loads what spectra over F call once all points are done."""
    import numpy as np

    from rodsweep.determinant.stability_changes import stability_change_between
    from rodsweep.model.rod import Rod

    rod, w = Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4), np.ones(1, complex)
    stability_change_between((rod.coefficients, rod.coefficient_derivative("F")), (1.0, 2.0), -w, w, 2)


def load_arms() -> None:
    """Loads what arms that vary along their length call beside, and keeps no solver for them."""
    from rodsweep.solve.backend.solver_pools import destroy_pooled_solvers
    from rodsweep.solve.seldom_used_functions import warm_up_arms

    warm_up_arms()
    destroy_pooled_solvers()


def find_provenance(solving: bool) -> None:
    """Finds commit and BLAS of this process once: asking git and all libraries takes as long as a run."""
    from rodsweep.results.file.provenance import provenance

    provenance()
    if solving:
        from rodsweep.solve.backend import petsc

        petsc.blas_description = cache(petsc.blas_description)
        petsc.blas_description()


def draw() -> None:
    """Draws a figure of all that figures have, so that no child loads fonts and what reads formulas."""
    from matplotlib.figure import Figure

    figure = Figure(layout="constrained")
    axes = figure.subplots()
    axes.loglog([1, 1e3], [1, 1e3], label=r"$\tilde k_1 = 10^{4}$")
    axes.set_title(r"$1.5\times10^{-3}$, a word")
    figure.legend()
    figure.savefig(io.BytesIO(), dpi=300)


def loaded_kernels() -> bytes:
    """{module: {name: the types of arguments for which it is compiled}} of what the package has loaded."""
    from numba.core.dispatcher import Dispatcher

    modules = {name: vars(module) for name, module in sys.modules.items() if name.startswith("rodsweep.")}
    return pickle.dumps(
        {
            name: {
                key: value.signatures
                for key, value in content.items()
                if isinstance(value, Dispatcher) and value.py_func.__module__ == name
            }
            for name, content in modules.items()
        }
    )


def load_for_ranks(kernels: bytes) -> None:
    """Loads what the process that solves has loaded, but what starts MPI or PETSc."""
    refusal = NoSolver()
    sys.meta_path.insert(0, refusal)
    for name, functions in pickle.loads(kernels).items():
        with suppress(AssertionError):
            module = import_module(name)
            for function, signatures in functions.items():
                for signature in signatures:
                    getattr(module, function).compile(signature)
    sys.meta_path.remove(refusal)
    assert not {"mpi4py.MPI", "petsc4py.PETSc"} & set(sys.modules)


def main() -> None:
    solving = sys.argv[1] == "solving"
    import_all()
    if solving:  # the fork has no solver yet
        reading, writing = os.pipe()
        if not os.fork():
            os.close(writing)
            keep_ranks(sys.argv[2], os.fdopen(reading, "rb"))
        os.close(reading)
    load(solving, sys.argv[3:])
    if solving:
        with os.fdopen(writing, "wb") as kernels:
            kernels.write(loaded_kernels())
    gc.freeze()  # collecting garbage, children would copy all that is loaded
    requests = sys.stdin.buffer
    with open(os.dup(1), "w", encoding="utf-8") as answers:
        os.dup2(2, 1)
        print("{}", file=answers, flush=True)
        for line in requests:
            request = json.loads(line)
            ended = answer_several(request) if "runs" in request else answer(request)
            print(json.dumps(ended), file=answers, flush=True)


if __name__ == "__main__":
    try:
        main()
    except IsRank as rank:
        found = rank
    else:
        found = None
    if found:
        be_rank(found.request, found.streams)
