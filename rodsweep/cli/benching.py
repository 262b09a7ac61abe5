"""The command `bench`: runs the benchmarks, prints their text, writes their numbers and figures."""

from collections.abc import Callable
from pathlib import Path

import click

from ..errors import EnvironmentLacks


def run_benchmarks(what: str | None, quick: bool, output: Path) -> None:
    """Runs one benchmark, or all; writes OUTPUT (Markdown), OUTPUT.h5 and OUTPUT_STUDY.png."""
    try:
        from ..bench.limit_cycle.study import limit_cycle_study
        from ..bench.machine import machine, where_and_when
        from ..bench.spectrum.study import spectrum_study
        from ..bench.study import Study
        from ..bench.sweep.study import sweep_study
        from ..bench.thresholds.study import thresholds_study
    except ModuleNotFoundError as error:
        raise EnvironmentLacks(f"the benchmark needs {error.name}: pip install 'rodsweep[bench]'") from None
    from ..results.file.measurements import write_measurements

    studies: dict[str, Callable[[bool], Study]] = {
        "spectrum": spectrum_study,
        "thresholds": thresholds_study,
        "limit_cycle": limit_cycle_study,
        "sweep": sweep_study,
    }
    done: list[Study] = []
    blocks = [where_and_when()]
    click.echo(blocks[0])
    for name in [what] if what else list(studies):
        study = studies[name](quick)
        done.append(study)
        blocks += [f"### {name}", study.text]
        click.echo("\n" + "\n\n".join(blocks[-2:]))
        if study.drawable:
            figure = output.with_name(f"{output.stem}_{name}.png")
            study.draw(figure)
            blocks.append(f"![Errors against time, {name}]({figure.name})")
        # After each study, so that nothing measured is lost with the next.
        output.write_text("\n\n".join(blocks) + "\n")
        write_measurements(output.with_suffix(".h5"), {s.name: s.table() for s in done}, machine())
