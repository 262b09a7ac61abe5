"""Commands and options of `rodsweep`, except the commands of `rodsweep.cli.output_commands`."""

import sys
from pathlib import Path

import click

from .. import __version__
from ..errors import InputError
from ..wording import counted, is_or_are
from .arm_options import NUMBER_TYPE, arm_options
from .file_names import FILE_TYPE, OUTPUT_OPTION_NAMES, link_target, result_file_path, with_suffix_replaced
from .launchers import launcher_rank_values
from .usage_errors import CommandGroupWithSuggestions

overrides_option = click.option(
    "--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Override a key, e.g. parameters.F.num=50."
)


@click.group(
    cls=CommandGroupWithSuggestions,
    context_settings={"help_option_names": ["-h", "--help"]},
    invoke_without_command=True,
)
@click.version_option(__version__, prog_name="rodsweep")
@click.pass_context
def commands(context: click.Context) -> None:
    """Spectra, thresholds, phase diagrams, modes, limit cycles and their branches of soft rods in a fluid."""
    if context.invoked_subcommand is None:  # click's own help differs between its releases
        click.echo(context.get_help(), err=True)
        sys.exit(2)


@commands.command()
@click.argument("config", type=FILE_TYPE)
@click.option(
    *OUTPUT_OPTION_NAMES,
    type=FILE_TYPE,
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

    stop = StopRequest(acknowledges=not launcher_rank_values())
    stop.listen_for_signals()  # first: a launcher's warning signal may come before slow imports are done
    from ..sweep.points.ranges import parsed_shard
    from .run.run_request import RunRequest
    from .run.running import run_config

    if options["fresh"] and options["extend"]:
        effects = "--fresh replaces the file, --extend adds points to it"
        raise InputError(f"--fresh and --extend are both given; give one of them: {effects}")
    parsed = parsed_shard(shard)
    suffix = f"-{parsed.number}-of-{parsed.shard_count}.h5" if parsed.shard_count > 1 else ".h5"
    output = result_file_path(output or Path(config.stem + suffix))
    code = run_config(config, output, RunRequest(overrides=overrides, shard=parsed, **options), stop)
    stop.ignore_signals()  # the status is decided
    sys.exit(code)


@commands.command()
@click.argument("output", type=FILE_TYPE)
@click.argument("shards", type=FILE_TYPE, nargs=-1, required=True, metavar="SHARD...")
def merge(output: Path, shards: tuple[Path, ...]) -> None:
    """Join the SHARD files, parts of a sweep or grids that form a larger grid, into the file OUTPUT."""
    from ..errors import STOPPED_EXIT_STATUS
    from ..results.file.combination.merge import merge as merge_files
    from ..tasks.running.job import plan_without_solver

    output = result_file_path(output)
    joined_file = merge_files(output, tuple(map(link_target, shards)), plan_without_solver)
    sources_text = counted(len(shards), "file")
    points_text = counted(joined_file.computed_point_count, "point")
    click.echo(f"{output}: {points_text} from {sources_text}, {joined_file.missing_point_count} missing")
    if joined_file.kernel_warning:
        click.echo(f"{output}: {joined_file.kernel_warning}")
    if joined_file.missing_point_count:
        click.echo(f"`rodsweep run CONFIG -o {output}` computes the missing points")
        sys.exit(STOPPED_EXIT_STATUS)
    if not joined_file.is_finished:
        click.echo(f"`rodsweep run CONFIG -o {output}` adds the variables that need all points")


@commands.command()
@click.argument("file", type=FILE_TYPE)
@click.option(*OUTPUT_OPTION_NAMES, type=FILE_TYPE, help="By default FILE's name with -snapshot before .h5.")
def snapshot(file: Path, output: Path | None) -> None:
    """Write the finished points of the result FILE, without disturbing the run."""
    from ..results.file.current_state import write_snapshot

    output = result_file_path(output or with_suffix_replaced(file, f"-snapshot{file.suffix}"))
    stored_count, points = write_snapshot(link_target(file), output)
    click.echo(f"wrote {output}: {stored_count} of {counted(points, 'point')} {is_or_are(points)} done")


@commands.command()
@click.argument("config", type=FILE_TYPE)
@overrides_option
def check(config: Path, overrides: tuple[str, ...]) -> None:
    """Validate CONFIG and print the points, the modelled effects and the expected cost, without computing."""
    from ..tasks.running.job import job_of_file
    from .checking import print_job_check

    print_job_check(job_of_file(config, overrides))


@commands.command()
@click.argument("file", type=FILE_TYPE)
@click.option("--statuses", is_flag=True, help="List all statuses of the task, not only those present.")
def show(file: Path, statuses: bool) -> None:
    """Print a summary of the result FILE: headline numbers, statuses, accuracy, cost."""
    from ..post.summary import show_summary
    from ..results.file.view import read_view

    show_summary(read_view(link_target(file)), statuses)


@commands.command()
def schema() -> None:
    """Print the JSON schema of a config, from which editors complete keys and mark mistakes."""
    import json

    from ..config.json_schema import json_schema

    click.echo(json.dumps(json_schema(), indent=2, allow_nan=False))


@commands.command()
@click.argument("what", type=click.Choice(["spectrum", "thresholds", "limit_cycle", "sweep"]), required=False)
@click.option("--quick", is_flag=True, help="Fewer rounds, rods and settings, for a first impression.")
@click.option(
    *OUTPUT_OPTION_NAMES,
    type=FILE_TYPE,
    help="Markdown file; the numbers (.h5) and figures go into the same folder.",
)
@click.option(
    "--peers", "directory", type=FILE_TYPE,
    help="Folder of the peers timed with rodsweep; by default `benchmarks` of the running checkout.",
)  # fmt: skip
def bench(what: str | None, quick: bool, output: Path | None, directory: Path | None) -> None:
    """Time WHAT (by default all studies) and the available peers, and state the error of every result."""
    from .benching import run_benchmarks

    output = output or Path("bench.md")
    is_other = output.exists() and not output.is_file()
    if is_other or not output.parent.is_dir() or output.suffix != ".md":
        raise InputError(f"--output {output}: the name must end in .md, in an existing directory")
    run_benchmarks(what, quick, output, directory)


@commands.command()
@arm_options()
@click.option(
    "--poisson", type=NUMBER_TYPE, default=0.5, show_default=True, help="Poisson's ratio of the arm."
)
def arm(poisson: float, segment: tuple[str, ...], **quantities: str | None) -> None:
    """Print when an arm flutters, from quantities with units such as "10 cm" and "100 kPa"."""
    from .arm_report import print_arm_report

    print_arm_report(quantities, poisson, segment)
