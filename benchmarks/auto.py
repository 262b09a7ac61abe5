"""AUTO-07p as a peer: compiles the program with the equations of a rod, runs it and reads its table."""

import os
import shutil
import subprocess
from pathlib import Path

AUTO = "AUTO-07p"
AUTO_LIBRARY = Path(os.environ.get("AUTO_DIR", "/usr/lib/auto-07p")) / "lib"
"""Folder with AUTO-07p's object files. AUTO-07p itself reads AUTO_DIR; the default is Debian's folder."""
HEAD_MARK = "0"
"""First word of every line in the head of AUTO's table, the file fort.7."""
AUTO_SKIPPED = f"{AUTO} is skipped: it needs the program (Debian: auto-07p) and gfortran."


def auto_program(directory: Path, equations: str) -> Path | None:
    """Compiles AUTO-07p with Fortran equations in a directory; None if AUTO-07p or gfortran is missing."""
    compiler, parts = shutil.which("gfortran"), sorted(map(str, AUTO_LIBRARY.glob("*.o")))
    if compiler is None or not parts:
        return None
    (directory / "equations.f90").write_text(equations)
    words = [compiler, "-O3", "-march=native", "-fopenmp", "equations.f90", *parts, "-o", "rod"]
    done = subprocess.run(words, cwd=directory, capture_output=True, check=False)
    return directory / "rod" if done.returncode == 0 else None


def run_auto(program: Path, folder: Path, constants: str) -> str:
    """Standard output of a run of the program in the directory `folder`, on one core.

    constants: content of AUTO's constants file fort.2. Raises RuntimeError if the program fails.
    """
    (folder / "fort.2").write_text(constants)
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    done = subprocess.run([program], cwd=folder, capture_output=True, text=True, check=False, env=environment)
    table = folder / "fort.7"
    if done.returncode or not (table.exists() and table.stat().st_size):
        raise RuntimeError(f"{AUTO} ended with status {done.returncode}")
    return done.stdout


def table_lines(folder: Path) -> list[list[str]]:
    """Words of each line of AUTO's table fort.7 in the directory `folder`, one line per point of the branch.

    The head of the table is left out.
    """
    lines = [line.split() for line in (folder / "fort.7").read_text().splitlines()]
    return [words for words in lines if words[0] != HEAD_MARK]
