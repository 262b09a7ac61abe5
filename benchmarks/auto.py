"""AUTO-07p as a peer: its program, compiled with the equations it is to follow, and a run of it."""

import os
import shutil
import subprocess
from pathlib import Path

AUTO = "AUTO-07p"
AUTO_LIBRARY = Path(os.environ.get("AUTO_DIR", "/usr/lib/auto-07p")) / "lib"
"""The compiled parts of AUTO-07p: AUTO_DIR is its own variable, the default is where Debian has it."""
HEAD = "0"
"""The first word of a line of the head of fort.7."""
SKIPPED = f"{AUTO} is skipped: it needs the program (Debian: auto-07p) and gfortran."


def auto_program(directory: Path, equations: str) -> Path | None:
    """AUTO-07p compiled in the directory with equations in Fortran; None where it or gfortran is missing."""
    compiler, parts = shutil.which("gfortran"), sorted(map(str, AUTO_LIBRARY.glob("*.o")))
    if compiler is None or not parts:
        return None
    (directory / "equations.f90").write_text(equations)
    words = [compiler, "-O3", "-march=native", "-fopenmp", "equations.f90", *parts, "-o", "rod"]
    done = subprocess.run(words, cwd=directory, capture_output=True, check=False)
    return directory / "rod" if done.returncode == 0 else None


def run_auto(program: Path, place: Path, constants: str) -> str:
    """What the program says in a run in the directory `place`, on one core; RuntimeError where it fails."""
    (place / "fort.2").write_text(constants)
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    done = subprocess.run([program], cwd=place, capture_output=True, text=True, check=False, env=environment)
    table = place / "fort.7"
    if done.returncode or not (table.exists() and table.stat().st_size):
        raise RuntimeError(f"{AUTO} ended with status {done.returncode}")
    return done.stdout


def table_lines(place: Path) -> list[list[str]]:
    """The words of the lines of fort.7, a line for each point of the branch; its head is left out."""
    lines = [line.split() for line in (place / "fort.7").read_text().splitlines()]
    return [words for words in lines if words[0] != HEAD]
