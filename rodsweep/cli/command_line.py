"""Commands and options of `rodsweep`."""

import sys
from pathlib import Path
from typing import Any

import click

from .. import __version__
from ..config.values import printable
from ..errors import InputError
from ..wording import counted
from .arm_options import arm_options
from .file_names import beside, followed, result_file
from .launchers import rank_variables

FILE = click.Path(path_type=Path)
overrides_option = click.option(
    "--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Override a key, e.g. parameters.F.num=50."
)


@click.group(context_settings={"help_option_names": ["-h", "--help"]}, invoke_without_command=True)
@click.version_option(__version__, prog_name="rodsweep")
@click.pass_context
def commands(context: click.Context) -> None:
    """Spectra, thresholds, phase diagrams, modes, limit cycles and their branches of soft rods in a fluid."""
    if context.invoked_subcommand is None:  # click's own help differs between its releases
        click.echo(context.get_help(), err=True)
        sys.exit(2)


@commands.command()
@click.argument("config", type=FILE)
@click.option(
    "-o",
    "--output",
    type=FILE,
    help="Result file; by default CONFIG's name with .h5, in the working directory.",
)
@overrides_option
@click.option("--fresh", is_flag=True, help="Replace an existing result file instead of continuing it.")
@click.option(
    "--extend", is_flag=True, help="Extend a result file; CONFIG must contain all points of the file."
)
@click.option(
    "--shard", metavar="I/N", default="1/1", help="Compute only part I of N; `merge` joins the parts."
)
@click.option("--strict", is_flag=True, help="End the run at the first exception that is a bug.")
@click.option("-q", "--quiet", is_flag=True, help="Print problems only; show no progress.")
def run(config: Path, output: Path | None, overrides: tuple[str, ...], shard: str, **options: bool) -> None:
    """Compute CONFIG, continuing an interrupted result file. Start it with mpiexec for many ranks."""
    from ..sweep.stop import StopRequest

    stop = StopRequest(acknowledges=not rank_variables())
    stop.listen()  # first: a launcher's warning signal may come before slow imports are done
    from ..sweep.points.ranges import shard_of
    from .run.options import RunOptions
    from .run.running import run_config

    if options["fresh"] and options["extend"]:
        raise InputError("--fresh and --extend are both given: one replaces the file, the other adds to it")
    part = shard_of(shard)
    suffix = f"-{part.number}-of-{part.of}.h5" if part.of > 1 else ".h5"
    output = result_file(output or Path(config.stem + suffix))
    code = run_config(config, output, RunOptions(overrides=overrides, shard=part, **options), stop)
    stop.ignore()  # the status is decided
    sys.exit(code)


@commands.command()
@click.argument("output", type=FILE)
@click.argument("shards", type=FILE, nargs=-1, required=True, metavar="SHARD...")
def merge(output: Path, shards: tuple[Path, ...]) -> None:
    """Put the points of all SHARD files into OUTPUT: parts of a sweep, or grids that form a larger grid."""
    from ..results.file.combination.merge import merge as merge_files
    from ..tasks.running.job import plan_without_solver
    from .run.running import CONTINUE

    output = result_file(output)
    merged = merge_files(output, tuple(map(followed, shards)), plan_without_solver)
    sources = counted(len(shards), "file")
    click.echo(f"{output}: {merged.points} points from {sources}, {merged.missing} missing")
    if merged.kernels:
        click.echo(f"{output}: {merged.kernels}")
    if merged.missing:
        click.echo(f"`rodsweep run CONFIG -o {output}` computes the missing points")
        sys.exit(CONTINUE)
    if not merged.finished:
        click.echo(f"`rodsweep run CONFIG -o {output}` adds the variables that need all points")


@commands.command()
@click.argument("file", type=FILE)
@click.option("-o", "--output", type=FILE, help="By default FILE's name with -snapshot before .h5.")
def snapshot(file: Path, output: Path | None) -> None:
    """Write the finished points of the result FILE, without disturbing the run."""
    from ..results.file.recent import take_snapshot

    output = result_file(output or beside(file, f"-snapshot{file.suffix}"))
    done, points = take_snapshot(followed(file), output)
    click.echo(f"wrote {output}: {done} of {points} points are done")


@commands.command()
@click.argument("config", type=FILE)
@overrides_option
def check(config: Path, overrides: tuple[str, ...]) -> None:
    """Validate CONFIG and print the points, the modelled effects and the expected cost, without computing."""
    from ..tasks.running.job import make_job
    from .checking import describe_job

    describe_job(make_job(config, overrides))


@commands.command()
@click.argument("file", type=FILE)
@click.option("--statuses", is_flag=True, help="List all statuses of the task, not only those present.")
def show(file: Path, statuses: bool) -> None:
    """Print a summary of the result FILE: headline numbers, statuses, accuracy, cost."""
    from ..post.summary import show_summary
    from ..results.file.view import read_view

    show_summary(read_view(followed(file)), statuses)


@commands.command()
@click.argument("files", type=FILE, nargs=-1, required=True, metavar="FILE...")
@click.option(
    "-o",
    "--output",
    type=FILE,
    help="Figure file (.png, .pdf, .svg; .gif or .mp4 for an animation); by default FILE's name.",
)
@click.option(
    "--roots",
    type=click.Choice(["rightmost", "smallest", "all"]),
    help="Roots of spectra to draw: all stored roots, or two roots of each point: the rightmost, or the "
    "smallest in magnitude, as in the paper; by default the choice whose curves swap places less often.",
)
@click.option(
    "--what",
    type=click.Choice(["cycle", "amplitude", "maps", "energy", "transient", "animation", "lines", "map"]),
    help="Figure of limit_cycle, or (lines, map) of thresholds; by default the figure that suits the file.",
)
@click.option(
    "--point",
    "points",
    type=int,
    multiple=True,
    metavar="N",
    help="Points of limit_cycle to draw, from 1; up to 3 times.",
)
@click.option(
    "--at",
    "at",
    multiple=True,
    metavar="NAME=VALUE",
    help="Draw only points with this value of a parameter, as k1=150, or of an arm, as 'length=12 cm'.",
)
@click.option("--title", is_flag=True, help="Put the title of the config above the figure.")
@click.option(
    "--width",
    metavar="WIDTH",
    help="Width of the figure, with type of 8 pt: single (3.375 in), double (7 in), or as '89 mm'.",
)
@click.option("--style", metavar="STYLE", help="Name or file of a matplotlib style.")
def plot(
    files: tuple[Path, ...],
    output: Path | None,
    roots: str | None,
    what: str | None,
    points: tuple[int, ...],
    at: tuple[str, ...],
    **look: Any,
) -> None:
    """Draw the result FILE; or several: spectra in panels, amplitudes of limit cycles in one figure."""
    from ..post.figures import draw
    from ..post.figures.request import Look
    from ..post.figures.sections import section
    from ..results.file.view import read_view
    from ..tasks.cycle_shapes import with_shapes

    output = output or beside(files[0], ".gif" if what == "animation" else ".png")
    values = _values(at)
    views = [section(read_view(followed(file)), values) for file in files]
    drawn = draw(views, output, look=Look(**look), shapes=with_shapes, roots=roots, what=what, points=points)
    click.echo(drawn)


def _values(at: tuple[str, ...]) -> dict[str, str]:
    """Values of `--at NAME=VALUE` by name; InputError for text of another form."""
    found = {}
    for text in at:
        name, equals, value = text.partition("=")
        if not equals:
            raise InputError(f"--at {printable(text)} must be a parameter with a number, such as k1=150")
        found[name.strip()] = value.strip()
    return found


@commands.command()
@click.argument("file", type=FILE)
@click.option("-o", "--output", type=FILE, help="A .csv or .tsv file; by default FILE's name with .csv.")
@click.option("--table", metavar="NAME", help="Table to write: points, or a list such as crossings.")
@click.option("--columns", metavar="A,B,C", help="Columns to write, in this order; by default all.")
@click.option("--units", is_flag=True, help="Put units into the headings: F_onset [k3/L^2].")
@click.option("--replace", is_flag=True, help="Overwrite an existing file.")
def export(
    file: Path, output: Path | None, table: str | None, columns: str | None, units: bool, replace: bool
) -> None:
    """Write a table of the result FILE as CSV: one row per point, or per item of a list."""
    from ..post.export import Request
    from ..post.export import export as export_view
    from ..results.file.view import read_view

    output = followed(output or beside(file, ".csv"))
    names = tuple(name.strip() for name in columns.split(",")) if columns is not None else ()
    request = Request(table=table, columns=names, units=units, replace=replace)
    click.echo(f"wrote {output}: {export_view(read_view(followed(file)), output, request)}")


@commands.command()
def schema() -> None:
    """Print the JSON schema of a config, from which editors complete keys and mark mistakes."""
    import json

    from ..config.json_schema import json_schema

    click.echo(json.dumps(json_schema(), indent=2, allow_nan=False))


@commands.command()
@click.argument("what", type=click.Choice(["spectrum", "thresholds", "limit_cycle", "sweep"]), required=False)
@click.option("--quick", is_flag=True, help="Fewer rounds, for a first impression.")
@click.option("-o", "--output", type=FILE, help="Markdown file; the numbers (.h5) and figures go beside it.")
@click.option(
    "--peers",
    "directory",
    type=FILE,
    help="Folder of the peers timed beside rodsweep; by default `benchmarks` of the running checkout.",
)
def bench(what: str | None, quick: bool, output: Path | None, directory: Path | None) -> None:
    """Time WHAT (by default all) beside its available peers, and state the error of every result."""
    from .benching import run_benchmarks

    output = output or Path("bench.md")
    unfit = output.exists() and not output.is_file()
    if unfit or not output.parent.is_dir() or output.suffix != ".md":
        raise InputError(f"--output {output}: the name must end in .md, in an existing directory")
    run_benchmarks(what, quick, output, directory)


@commands.command()
@arm_options()
@click.option("--poisson", type=float, default=0.5, show_default=True, help="Poisson's ratio of the arm.")
def arm(poisson: float, segment: tuple[str, ...], **quantities: str | None) -> None:
    """Print when an arm flutters, from quantities with units such as "10 cm" and "100 kPa"."""
    from .arm_report import describe_arm

    describe_arm(quantities, poisson, segment)
