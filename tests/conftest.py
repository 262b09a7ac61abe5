"""What tests share: the command as a user runs it, and the reference spectra."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
BIN = Path(sys.executable).parent


class Command:
    """`rodsweep` in a directory of its own, alone or under mpiexec."""

    def __init__(self, directory: Path):
        self.directory = directory

    def argv(self, *words: object, ranks: int = 0) -> list[str]:
        launcher = [str(BIN / "mpiexec"), "-n", str(ranks)] if ranks else []
        return [*launcher, str(BIN / "rodsweep"), *map(str, words)]

    def __call__(self, *words: object, ranks: int = 0, timeout: float = 300) -> subprocess.CompletedProcess:
        return subprocess.run(
            self.argv(*words, ranks=ranks),
            cwd=self.directory,
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
            env=os.environ | {"COLUMNS": "120"},
        )

    def write(self, name: str, text: str) -> Path:
        path = self.directory / name
        path.write_text(text)
        return path


@pytest.fixture
def command(tmp_path):
    return Command(tmp_path)


@pytest.fixture(scope="session")
def reference_spectra():
    return json.loads((ROOT / "tests" / "reference" / "spectra.json").read_text())
