"""Many runs of the command, each in a process of its own with a limit of time and of memory."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

SERVER = Path(__file__).with_name("server.py")
PATIENCE = 300.0
"""Seconds by the clock after which a run counts as one that hangs: more than any takes on a busy machine."""

HUGE_PAGES = {"GLIBC_TUNABLES": "glibc.malloc.hugetlb=1"}
"""For the loaded process: to fork it takes half the time where its memory lies in pages of megabytes."""


@dataclass(frozen=True)
class Outcome:
    """How one run ended."""

    status: int
    """Exit status; negative: the signal that ended it."""
    slow: bool
    """Whether it was ended because it took too long."""
    out: str
    err: str

    @property
    def fault(self) -> str:
        """What no run may do, whatever its input; empty if it did nothing of the kind."""
        if self.slow:
            return "it hangs"
        if self.status < 0:
            return f"it crashes with signal {-self.status}"
        if self.status not in (0, 1, 2, 3, 75) or "Traceback" in self.err + self.out:
            return f"it ends with a traceback: {' '.join(self.err.split())[-300:]}"
        return self.unclear if self.status in (2, 3) else ""

    @property
    def unclear(self) -> str:
        """Why a refusal is not one clear sentence; empty if it is."""
        if not self.err.startswith("rodsweep: ") or self.err.count("\n") != 1:
            return f"a refusal of other than one line: {self.err[:300]!r}"
        if len(self.err) > 400:
            return f"a refusal of {len(self.err)} characters: {self.err[:300]!r}"
        if not self.err[:-1].isprintable():
            return f"a refusal that cannot be printed: {self.err!r}"
        return ""


class Isolated:
    """The command, as a function of its arguments."""

    def __init__(self, server: subprocess.Popen, directory: Path):
        self.server, self.directory = server, directory
        self.ranks = directory / "ranks"
        """Socket of the process from which ranks are forked, where solvers are loaded."""

    def __call__(
        self,
        directory: Path,
        *words: object,
        seconds: int | None = 2,
        memory: float | None = 500e6,
        points: int | None = None,
        patch: str = "",
        environment: dict[str, str] | None = None,
        patience: float = PATIENCE,
        call: str = "command",
    ) -> Outcome:
        """Runs `rodsweep words...` in a directory, with `memory` bytes more than are taken when it starts.

        `seconds` are of the processor's time, and no limit if None; a run is killed when it has finished so
        many `points`. `patch` is Python that it executes first, as a sitecustomize.py would.
        """
        streams = {name: self.directory / name for name in ("stdout", "stderr")}
        request: dict[str, Any] = {
            "call": call,
            "directory": str(directory),
            "words": [os.fsencode(str(word)).hex() for word in words],
            "seconds": seconds,
            "memory": None if memory is None else int(memory),
            "points": points,
            "patch": patch,
            "environment": environment or {},
            "patience": patience,
        }
        answer = self._ask(json.dumps(request | {name: str(path) for name, path in streams.items()}))
        out, err = (path.read_text(errors="backslashreplace") for path in streams.values())
        return Outcome(answer["status"], answer["slow"], out, err)

    def several(
        self, runs: Sequence[tuple[Path, Sequence[object]]], seconds: int = 2, memory: float = 500e6
    ) -> list[Outcome]:
        """Runs of the command, each in a directory of its own, which forks a child only where one has ended.

        Beside each directory there are files of its run then. `seconds` are those of each, `memory` of all.
        """
        asked = [
            (str(directory), [os.fsencode(str(word)).hex() for word in words]) for directory, words in runs
        ]
        limits = {"seconds": seconds, "memory": int(memory), "patience": PATIENCE}
        ended = self._ask(json.dumps({"runs": asked} | limits))["runs"]
        outcomes = []
        for (directory, _), one in zip(runs, ended, strict=True):
            out, err = (
                directory.with_name(name).read_text(errors="backslashreplace")
                for name in ("stdout", "stderr")
            )
            outcomes.append(Outcome(one["status"], one["slow"], out, err))
        return outcomes

    def content(self, path: Path) -> dict[str, list]:
        """Type, shape and bytes of each variable of a file but `seconds`; empty if it cannot be read."""
        outcome = self(path.parent, path.name, call="content")
        return {} if outcome.status else json.loads(outcome.out)

    def _ask(self, request: str) -> dict:
        self.server.stdin.write(request + "\n")
        self.server.stdin.flush()
        return self.answer()

    def answer(self) -> dict:
        """The server's next answer."""
        line = self.server.stdout.readline()
        assert line, f"the server of isolated runs ended with status {self.server.wait()}"
        return json.loads(line)


@contextmanager
def isolated(configs: list[Path], solving: bool = False) -> Iterator[Isolated]:
    """Isolated runs; what `configs` need is loaded before. Unless `solving`, no solver may be imported."""
    with tempfile.TemporaryDirectory() as name:
        server = subprocess.Popen(
            [
                *(sys.executable, str(SERVER), "solving" if solving else "reading"),
                *(str(Path(name) / "ranks"), *map(str, configs)),
            ],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=dict(os.environ) | {"COLUMNS": "1000"} | HUGE_PAGES,
        )
        try:
            run = Isolated(server, Path(name))
            run.answer()
            yield run
        finally:
            server.stdin.close()
            server.wait(60)
            server.stdout.close()
