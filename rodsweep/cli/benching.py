"""The command `bench`: runs the benchmarks, prints their tables, writes numbers and figures."""

import platform
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

import click

from ..errors import EnvironmentIncomplete
from ..results.file.provenance import cpu_name, provenance, utc_time
from ..solve.backend import petsc

MEASURED_COMMAND = (sys.executable, "-m", f"{__package__}.measured_command")
"""Command that starts `rodsweep` in the runs measured by the benchmark of the sweep."""
REPORT_HEADING = """# Performance

Speed against error of rodsweep, measured on one machine in one run of `rodsweep bench`. The peers, which a
user might choose instead, are in the folder `benchmarks` of a checkout. Times are processor times, but clock
times in `sweep`. All methods run in turn, round after round; the tables show medians. Compare methods within
a table, not times between machines, and read each time together with its error: a method is faster only at
equal accuracy. An HDF5 file beside the text has every number with all settings."""


def run_benchmarks(study_name: str | None, is_quick: bool, output: Path, directory: Path | None) -> None:
    """Runs benchmarks; writes `output` (Markdown) and, in the same folder, one file .h5 with the numbers of
    all studies, and a figure _STUDY.png for each study that can be drawn.

    study_name: name of the study, None for all studies. is_quick: whether fewer rounds are run, on fewer
    rods, sizes or settings. directory: folder of the peers, None for the folder `benchmarks` of the running
    checkout. Raises EnvironmentIncomplete if a package of the benchmark is missing.
    """
    try:
        from ..bench.limit_cycle.study import run_limit_cycle_study
        from ..bench.peers import PeerContribution, left_out_peers_sentence, peer_package, peers_of_study
        from ..bench.spectrum.study import run_spectrum_study
        from ..bench.study import BenchmarkReport
        from ..bench.sweep.study import run_sweep_study
        from ..bench.thresholds.study import run_thresholds_study
    except ModuleNotFoundError as error:
        hint = f"the benchmark needs {error.name}: pip install 'rodsweep[bench]'"
        raise EnvironmentIncomplete(hint) from None
    from ..results.file.benchmark_file import write_measurements

    studies: dict[str, Callable[[bool, PeerContribution], BenchmarkReport]] = {
        "spectrum": run_spectrum_study,
        "thresholds": run_thresholds_study,
        "limit_cycle": run_limit_cycle_study,
        "sweep": lambda is_quick, _: run_sweep_study(is_quick, MEASURED_COMMAND),
    }
    package = peer_package(directory)
    names = [study_name] if study_name else list(studies)
    tables = {}
    blocks = [REPORT_HEADING, machine_and_versions_line(package.versions() if package else {})]
    if package is None and (sentence := left_out_peers_sentence(names)):
        blocks.append(sentence)
    click.echo("\n\n".join(blocks[1:]))
    for name in names:
        with TemporaryDirectory(prefix="rodsweep-bench-") as folder:
            study = studies[name](is_quick, peers_of_study(package, name, is_quick, Path(folder)))
        tables[name] = study.table()
        blocks += [f"## {name}", study.text]
        click.echo("\n" + "\n\n".join(blocks[-2:]))
        if study.is_drawable:
            figure = output.with_name(f"{output.stem}_{name}.png")
            study.draw(figure)
            blocks.append(f"![Errors against time, {name}]({figure.name})")
        # After each study, so that nothing measured is lost with the next.
        output.write_text("\n\n".join(blocks) + "\n")
        write_measurements(output.with_suffix(".h5"), tables, machine_attributes())


def machine_attributes() -> dict[str, str]:
    """Processor, date and versions, as attributes of the file of measurements."""
    return {"processor": cpu_name(), "created": utc_time()} | provenance() | petsc.library_versions()


def machine_and_versions_line(peers: Mapping[str, str]) -> str:
    """Processor, date and versions in one line of text. peers: versions of the peers by name."""
    versions = petsc.library_versions() | {
        package.removesuffix("_version"): package_version for package, package_version in provenance().items()
    }
    versions_to_print = {name: versions[name] for name in ("rodsweep", "petsc", "slepc", "numpy", "python")}
    versions_text = ", ".join(
        f"{name} {version}" for name, version in (versions_to_print | dict(peers)).items()
    )
    return f"One core of {cpu_name()}, {platform.system()}, {utc_time()[:10]}; {versions_text}. Threads: one."
