"""Writes docs/file-format.md, and the tables at the end of the page of each task, docs/tasks/TASK.md.

    python docs/reference.py

The tables come from the models of the config and the layouts of the result files: keys and variables are
explained where they are declared. This module has the layout of the tables, and the meanings of words and
attributes without a declaration. `tests/test_docs.py` compares the pages with `pages()`.
"""

import inspect
import tempfile
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np
from pydantic.fields import FieldInfo

from rodsweep.config.arm.section import ArmConfig
from rodsweep.config.document.refusals import allowed_values_text
from rodsweep.config.json_schema import key_docstrings
from rodsweep.config.material import MaterialConfig, ProfileTable
from rodsweep.config.task.phase_diagram import PhaseDiagramConfig
from rodsweep.config.tasks import CONFIG_CLASSES_BY_TASK
from rodsweep.model.arm.quantities import ARM_FILE_VARIABLES
from rodsweep.model.parameters import PARAMETERS
from rodsweep.results.file.validation import FORMAT_NUMBER
from rodsweep.results.layouts.detached_branches import (
    DETACHED_ROW_VARIABLES_BY_NAME,
    LOST_CURVE_ENDS_VARIABLE,
)
from rodsweep.results.layouts.dimensions import UNIT_AND_LONG_NAME_OF_DIMENSION
from rodsweep.results.layouts.fold_curve_extrema import (
    UNLOCATED_EXTREMA_VARIABLE,
    fold_curve_extremum_variables,
)
from rodsweep.results.layouts.phase_diagram import (
    CYCLE_CURVE_END_REASONS,
    STABILITY_CLASSES,
    STABLE_STATES,
    bautin_curve_variables,
    boundary_curve_variables,
    criticality_variables,
    cycle_curve_variables,
)
from rodsweep.results.layouts.si_variables import VALIDITY_VARIABLES
from rodsweep.results.layouts.spectrum import FORCE_THRESHOLD_VARIABLES
from rodsweep.results.layouts.thresholds import CROSSING_KINDS, CROSSING_MEANINGS
from rodsweep.results.layouts.variables import MISSING_STATUS, Variable
from rodsweep.tasks.arm.arm_points import OutsideModelStatus
from rodsweep.tasks.running.job import Job, job_of_file

DOCS = Path(__file__).parent
MARK = "<!-- Written by `python docs/reference.py` from here on; change it there. -->\n"
"""Line of a task's page that divides what people write, above, from the tables."""

WHOLE = {
    "spectrum": """
        parameters: {F: 30, k1: 200, k2: 1.0e+4, gamma3: 1.0e-4, gamma1: 1}
        spectrum: {vectors: true, longitudinal: true}""",
    "thresholds": "parameters: {k1: 200, k2: 1.0e+4, gamma3: 1.0e-4}",
    "phase_diagram": """
        parameters: {F: [0, 100], k1: [200, 300], k2: 1.0e+4, gamma3: 1.0e-4, gamma1: 1}
        phase_diagram: {criticality: true, cycles: true, bautin_along: {k2: [5.0e+3, 2.0e+4]}}""",
    "modes": "parameters: {F: 30, k1: 200, k2: 1.0e+4, gamma3: 1.0e-4}",
    "criticality": "parameters: {k1: 200, k2: 1.0e+4, gamma3: 1.0e-4, gamma1: 1}",
    "branch": "parameters: {k1: 200, k2: 1.0e+4, gamma3: 1.0e-4, gamma1: 1}",
    "limit_cycle": """
        parameters: {F: 50, k1: 1.0e+4, k2: 100, gamma3: 0.01, gamma1: 1}
        limit_cycle: {samples: 64, shapes: 8, transient: 99, time: tau1}""",
}
"""A config of every task with all parameters and all optional variables."""
WITHOUT = {
    "phase_diagram.cycles: true": ("phase_diagram.cycles=false",),
    "spectrum.vectors: true": ("spectrum.vectors=false",),
    "spectrum.longitudinal: true": ("spectrum.longitudinal=false", "parameters.gamma1=null"),
    "modes.growth: true": ("modes.growth=false",),
    "limit_cycle.samples > 0": ("limit_cycle.samples=0",),
    "limit_cycle.transient > 0": ("limit_cycle.transient=0",),
    "limit_cycle.shapes > 0": ("limit_cycle.shapes=0",),
    "limit_cycle.time: tau1": ("limit_cycle.time=tau2",),
}
"""Overrides that remove the variables depending on an option, by the option."""
LENGTHS = {
    "point": "lines of the CSV file",
    "mode": "`spectrum.modes`, `modes.modes`",
    "u": "`spectrum.nodes`, `modes.nodes`, `limit_cycle.nodes`",
    "crossing": "`thresholds.crossings`, `phase_diagram.crossings`, `criticality.crossings`",
    "curve_point": "as found",
    "change": "as found",
    "hopf": "as found",
    "fold": "as found",
    "bautin": "as found",
    "cycle_special": "64",
    "cycle_curve_point": "as found",
    "cycle_extremum": "as found",
    "cycle_detached": "as found",
    "bautin_step": "as found",
    "branch_point": "`branch.cycles`",
    "special": "`branch.special`",
    "harmonic": "`limit_cycle.harmonics`",
    "multiplier_number": "6",
    "sample": "`limit_cycle.samples`",
    "shape": "`limit_cycle.shapes`",
    "transient": "`limit_cycle.transient`",
}
"""Origin of the length of each dimension that is no parameter."""
MOTIONS = {
    "missing": "not computed",
    "monotone": "stable; the slowest mode decays without oscillations",
    "oscillatory": "stable; the slowest mode decays with oscillations",
    "flutter": "at least one mode grows",
    "undecided": "on a boundary within its error, or not known",
    "crushed": "F >= k1: there is no rod",
}
"""State of the rod at a point of a phase diagram."""
STATES = {
    "missing": "not computed",
    "neither_known": "the straight rod is unstable, and no stable cycle lies on a branch that was followed",
    "straight": "the straight rod is stable, and no stable cycle is known",
    "cycle": "a cycle is stable, and the straight rod is not",
    "both": "the straight rod and a cycle are stable; the start decides which one is reached",
    "undecided": "on a boundary within its error, or a branch could not be followed to its end",
    "crushed": "F >= k1: there is no rod",
}
"""Stable states at a point of a phase diagram with cycles."""
ATTRIBUTES = {
    "program": "`rodsweep`: what a result file is recognised by",
    "Conventions": "`CF-1.8`",
    "title, task": "title and task of the config; without a title, the name of the file",
    "config": "text of the config of the last run, with its comments; changes by `--set` are at its end",
    "config_resolved": "the config with all defaults, as JSON",
    "snapshot": "time at which `rodsweep snapshot` wrote the file; empty once a run has continued it",
    "format": f"version of the layout, {FORMAT_NUMBER}; "
    "see [which version reads what](#which-version-reads-what)",
    "seal": "a digest of every variable and attribute; see [the seal](#the-seal)",
    "fingerprint": "digest of the meaning of the config and of all points; a run continues a file of its own "
    "fingerprint only",
    "time_unit": "`tau2 = gamma2 L^4/k3`",
    "gamma1": "axial drag, if the config of a spectrum or a phase diagram gives it",
    "coordinates": "names of the parameters along `point` in a list of points; names of an arm's coordinates",
    "status_sentences": "sentence of every status, one a line",
    "failure_reasons": "for each distinct reason of failure, in all runs, the first failed point: its "
    "parameters, status and reason, one a line; at most 20",
    "rodsweep_version, git_commit": "version and commit of the program; `-dirty` marks uncommitted changes",
    "python_version, numpy_version, numba_version": "versions of Python and the libraries",
    "mpi4py_version, h5py_version, hdf5_version": "versions of the libraries",
    "petsc_version, petsc4py_version, slepc_version, slepc4py_version": "versions of the solvers",
    "petsc_options": "value of `PETSC_OPTIONS`",
    "blas_kernels": "BLAS libraries and kernels that computed points of the file, one a line",
    "system, mpi_library": "operating system, and MPI",
    "ranks, hosts": "number of ranks of the last run, and names of its hosts",
    "rank_points, rank_busy_seconds, rank_idle_seconds": "points and times of each rank of the last run",
    "started, finished": "times of the last run, UTC; `finished` only if no point is missing",
    "stopped": "signal that stopped the last run, or empty",
    "shard": "part `i/n` of the points in the file, or empty",
    "slurm_job": "number of the last run's Slurm job, or empty",
}
"""The attributes of a file."""

HEAD = """\
# Config and result file

<!-- Written by `python docs/reference.py` from the code; change it there. -->

What all tasks share: parameters, keys, and the layout of a result file. The keys, variables and statuses
of each task are on [the page of the task](tasks/index.md); [Write and run a config](howto/configs.md) shows
keys in use.

## Units

Lengths are in L, forces in k3/L^2, time in tau2 = gamma2 L^4/k3. So the bending stiffness k3 and the
transverse drag gamma2 are 1. e1 is the tangent of the rod, from the clamp to the tip; a force
along -e1 pushes the tip towards the clamp.

## The config

YAML 1.2, at most 100 kB, without anchors, tags and directives. An unknown key, or an option of a different
task, is refused in a sentence that names the nearest known key.
"""
RANGES = """
An axis is

- a number: `k1: 200`, `k1: inf`;
- a list in increasing order, each number once: `k1: [200, 1.0e4, inf]`;
- a range: `{start: 10, stop: 1.0e6, num: 31, spacing: log}`; `spacing` is `linear` (the default) or `log`.

F must be below every k1; only a phase diagram may contain crushed rods, F >= k1. A phase diagram needs
exactly two parameters with several values. A spectrum takes gamma1, a single number, only with
`spectrum.longitudinal: true`. A phase diagram takes gamma1, a single number, only with
`phase_diagram.criticality: true` or `cycles: true`; the default is 1, or gamma1 of the arm. The header of a
CSV file names the parameters of the task, in any order.
"""
FILE = """
## The result file

netCDF-4-compatible HDF5. Below, `...` stands for the dimensions of the points: the parameters of the task in
their order, or `point` for a list of points, in whose file each parameter is a variable along `point`. Words
are stored as numbers, with the attributes `flag_values` and `flag_meanings`. The column "if missing" has the
stored value of a number that does not exist, such as the period of a straight rod, or is not computed yet.

### The seal

The attribute `seal` is JSON: a digest (16 digits of SHA-256) of every variable, with its type, shape,
dimensions and attributes, and of every attribute of the file. All readers (`show`, `plot`, `export`, `run`,
`merge`, `snapshot`, `rs.open`) check the seal before reading, and refuse every change in one sentence: a
changed number, axis, unit or config; links of any kind; variables stored in a different file; variables and
attributes that rodsweep did not write. Variables and attributes whose names begin with `user_` are free for
your use: rodsweep keeps these when a run continues, and only `rs.open` reads them. After undoing a change the
file is valid again.

A checksum of HDF5's structures follows the end of the HDF5 data, where HDF5 ignores it; rodsweep checks the
structures before HDF5 reads the file. A program that opens the file for writing removes this checksum, and
the file stays valid.
"""
VERSIONS = f"""
### Which version reads what

The attribute `format` is a whole number, now {FORMAT_NUMBER}, that grows when a variable is added or changes
its meaning.

- A file of a higher format is refused in one sentence that names the version of the program that wrote the
  file.
- A file of a lower format, or without the attribute, is refused in one sentence that names the version and
  the commit of the program that wrote the file, and that can read the file.

HDF5, netCDF and xarray read files of every format.
"""
TAIL = """
### Attributes

"""


def text() -> str:
    """The page about what all tasks share."""
    attributes = (([code(names), what]) for names, what in ATTRIBUTES.items())
    return "".join(
        [
            *(HEAD, "\n### Parameters\n\n", parameters(), RANGES, common_keys(), FILE),
            *("\n### Dimensions\n\n", dimensions()),
            *(ARM, quantities(), "\n", validity()),
            *(TAIL, table(("attribute", "meaning"), attributes), VERSIONS),
        ]
    )


def task_page(task: str) -> str:
    """The page of a task: what people wrote, then the tables."""
    written = task_path(task).read_text().partition(MARK)[0].rstrip()
    return f"{written}\n\n{MARK}\n{task_keys(task)}\n{task_variables(task)}"


def task_path(task: str) -> Path:
    return DOCS / "tasks" / f"{task}.md"


def parameters() -> str:
    """Table of the parameters and their tasks."""
    tasks = {task: whole(task).config.parameters for task in CONFIG_CLASSES_BY_TASK}
    rows = []
    for name, p in PARAMETERS.items():
        having = [task for task, given in tasks.items() if getattr(given, name) is not None]
        default = "" if p.default is None else f"{p.default:g} as an axis; none for a spectrum"
        if p.is_optional:
            having = list(CONFIG_CLASSES_BY_TASK)
            default = f"{p.default:g}; a dimension of the file only if given"
        key, allowed = f"`parameters.{name}`", p.allowed_range.description
        where = "all" if having == list(CONFIG_CLASSES_BY_TASK) else code(", ".join(having))
        rows.append([key, allowed, default, p.unit, p.long_name, where])
    return table(("key", "allowed", "default", "unit", "meaning", "tasks"), rows)


def common_keys() -> str:
    """Table of the keys of every task."""
    config = CONFIG_CLASSES_BY_TASK["spectrum"]
    meanings = key_docstrings(config)
    points = config.model_fields["parameters"].annotation
    assert isinstance(points, type)
    rows = [["`task`", code(", ".join(CONFIG_CLASSES_BY_TASK)), "", "What is computed."]]
    rows += [key_row(name, config.model_fields[name], meanings[name]) for name in ("title", "accuracy")]
    for name in ("points", "columns", "arm"):
        rows.append(key_row(f"parameters.{name}", points.model_fields[name], key_docstrings(points)[name]))
    meanings = key_docstrings(ArmConfig)
    fields = ArmConfig.model_fields
    rows += [key_row(f"parameters.arm.{name}", field, meanings[name]) for name, field in fields.items()]
    return "\n### Keys of every task\n\n" + key_table(rows) + material_keys()


def material_keys() -> str:
    """Table of the keys of the material and the columns of its profile."""
    rows = [
        key_row(f"{place}.{name}", field, key_docstrings(section)[name])
        for place, section in (("material", MaterialConfig), ("material.profile", ProfileTable))
        for name, field in section.model_fields.items()
    ]
    return "\n### Keys of the material\n\n" + key_table(rows)


KEYS_OF_ALL = "Further keys: [parameters and keys of every task](../file-format.md#the-config)."


def task_keys(task: str) -> str:
    """Keys of one task: options, and the accuracy if the task has a different default."""
    config = CONFIG_CLASSES_BY_TASK[task]
    rows = []
    if (
        config.model_fields["accuracy"].default
        != CONFIG_CLASSES_BY_TASK["spectrum"].model_fields["accuracy"].default
    ):
        rows.append(key_row("accuracy", config.model_fields["accuracy"], key_docstrings(config)["accuracy"]))
    section = config.model_fields[task].annotation
    assert isinstance(section, type)
    meanings = key_docstrings(section)
    rows += [key_row(f"{task}.{name}", field, meanings[name]) for name, field in section.model_fields.items()]
    return f"## Config keys\n\n{inspect.getdoc(config)} {KEYS_OF_ALL}\n\n" + key_table(rows)


def key_row(name: str, field: FieldInfo, meaning: str) -> list[str]:
    """A key as a row of a table."""
    default = "" if field.is_required() else yaml_of(field.default)
    return [f"`{name}`", allowed_values_text(field), default, meaning]


def yaml_of(value: object) -> str:
    """A default value as in a config; "" without default."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, float) else str(value)


def key_table(rows: Sequence[Sequence[str]]) -> str:
    return table(("key", "allowed", "default", "meaning"), rows)


def dimensions() -> str:
    """Table of all dimensions except the parameters."""
    rows = [
        [f"`{name}`", LENGTHS[name], meaning]
        for name, (_, meaning) in UNIT_AND_LONG_NAME_OF_DIMENSION.items()
        if name not in PARAMETERS
    ]
    return table(("dimension", "length", "its coordinate"), rows)


ARM = """
### File of an arm

If only the load or Poisson's ratio of `parameters.arm` have several values, the points are a grid of
parameters: `pressure` or `force` is a coordinate along F, `poisson` along k2; in a phase diagram `drag` and
tau2 are coordinates along gamma3. If a different quantity has several values, or if the load is relative to
flutter, the points are a grid over the arm's quantities and the parameters beside the arm. Every quantity or
parameter with several values is a dimension, in SI, with the user's unit as attribute `typed_unit`; F, k1,
k2, gamma3, gamma1 and the units below are coordinates on the grid. A quantity with one value is a number.

Variables with the units tau2, rad/tau2, 1/tau2, L, k3/L or k3/(L tau2), and forces, are also stored in SI:
`period_si` in s, `frequency_hz` in cycles per second, `growth_rate_si` in 1/s; a force F as the load, such as
`pressure_hopf` in Pa for `F_hopf`, or `force_hopf` in N for an arm with a force; and `frequency_hopf_hz` for
`hopf_frequency`. Larger tables than those of modes, crossings and branches, and the curves, crossings and
cycles of a phase diagram, are stored without SI variables: multiply a force by `pressure_scale` or
`force_scale`, and a time by `tau2`.

"""
UNCOVERED = """
At a point of a grid whose arm is outside the model nothing is computed, and `status` is

"""


def validity() -> str:
    """Variables on the validity of the model, and statuses of arms without a rod."""
    statuses = [[str(int(s)), f"`{s.name}`", s.sentence] for s in sorted(OutsideModelStatus)]
    variables = variable_table(variable_row(v, ["...", *v.extra_dimensions]) for v in VALIDITY_VARIABLES)
    return variables + UNCOVERED + table(("value", "word", "meaning"), statuses)


def quantities() -> str:
    """Table of the coordinates of an arm."""
    rows = [[f"`{name}`", each.unit, each.meaning] for name, each in ARM_FILE_VARIABLES.items()]
    return table(("coordinate", "unit", "meaning"), rows)


def kinds() -> list[tuple[int, str]]:
    return list(enumerate(CROSSING_KINDS))


def words(title: str, meanings: dict[str, str], flags: Iterable[tuple[int, str]]) -> str:
    """Table of the values of a variable that stand for words."""
    rows = [[str(value), f"`{word}`", meanings[word]] for value, word in flags]
    return f"\n### {title}\n\n" + table(("value", "word", "meaning"), rows)


FILE_OF_ALL = "Further variables and attributes: [the result file](../file-format.md#the-result-file)."


def task_variables(task: str) -> str:
    """Tables of the variables and the statuses of one task."""
    job = whole(task)
    given = variables_of(job)
    only = {
        name: condition
        for condition, overrides in WITHOUT.items()
        if condition.startswith(f"{task}.")
        for name in given.keys() - variables_of(whole(task, overrides)).keys()
    }
    rows = [(only.get(name, ""), variable_row(variable, dims)) for name, (variable, dims) in given.items()]
    points = f"`...` is ({', '.join(job.layout.parameters)}), or (point)."
    statuses = [[str(MISSING_STATUS), "`missing`", "not computed yet"]]
    statuses += [
        [str(int(s)), f"`{s.name}`", s.sentence] for s in sorted(job.task.solver().possible_statuses)
    ]
    parts = [f"## Variables of the file\n\n{points} {FILE_OF_ALL}\n\n", tables_by_condition(rows)]
    if task == "phase_diagram":
        parts += ["\n### Curves\n", CURVES, tables_by_condition(curve_rows(job))]
    if "crossing_kind" in given:
        parts.append(words("Kinds of a crossing", CROSSING_MEANINGS, kinds()))
    if task == "phase_diagram":
        parts += words_of_diagrams()
    return "".join([*parts, "\n## Statuses\n\n", table(("value", "word", "meaning"), statuses)])


def words_of_diagrams() -> list[str]:
    """Tables of the words in the file of a phase diagram."""
    ends = tuple(enumerate(CYCLE_CURVE_END_REASONS))
    return [
        words("Classes", MOTIONS, STABILITY_CLASSES),
        words("Stable states with cycles", STATES, STABLE_STATES),
        words("Ends of curves of folds and torus points", CYCLE_CURVE_END_REASONS, ends),
    ]


CURVES = """
With `phase_diagram.curves: true` the file also has the following variables, once all rows are finished. A row
is a line along the first parameter with several values, in the order F, k1, k2, gamma3. The tables below are
for a diagram over F and k1; in a diagram over different parameters their names replace `F` and `k1`.

"""


def curve_rows(job: Job) -> Iterator[tuple[str, list[str]]]:
    """(condition, row) of each variable of the curves of a phase diagram."""
    assert isinstance(job.config, PhaseDiagramConfig)
    line, row = job.config.plane_parameters
    for variable in boundary_curve_variables(line, row).values():
        is_of_limit = variable.name.startswith(("partial_beam", "filament"))
        yield (
            "diagrams over F and k1" if is_of_limit else "",
            variable_row(variable, list(variable.extra_dimensions)),
        )
    for variable in criticality_variables(line, row).values():
        yield "phase_diagram.criticality: true", variable_row(variable, list(variable.extra_dimensions))
    cycle_curves = cycle_curve_variables(line, row) | fold_curve_extremum_variables(line, row)
    counts = UNLOCATED_EXTREMA_VARIABLE, LOST_CURVE_ENDS_VARIABLE
    for variable in (*(cycle_curves | DETACHED_ROW_VARIABLES_BY_NAME).values(), *counts):
        yield "phase_diagram.cycles: true", variable_row(variable, list(variable.extra_dimensions))
    third = job.config.phase_diagram.bautin_name_and_axis
    assert third is not None
    for variable in bautin_curve_variables(line, row, third[0]).values():
        yield "phase_diagram.bautin_along", variable_row(variable, list(variable.extra_dimensions))


def variables_of(job: Job) -> dict[str, tuple[Variable, list[str]]]:
    """The variables of a job's file by name, each with its dimensions."""
    found = {v.name: (v, ["...", *v.extra_dimensions]) for v in job.layout.variables}
    beside = [v for v, _ in job.task.variables_from_config()]
    if job.config.task in ("spectrum", "modes"):
        beside += FORCE_THRESHOLD_VARIABLES
    return found | {v.name: (v, list(v.extra_dimensions)) for v in beside}


def variable_row(variable: Variable, dims: list[str]) -> list[str]:
    """A variable as a row of a table."""
    meaning = variable.long_name.replace("for gamma1 = 1", "for gamma1 of the config")
    if variable.is_boolean:
        meaning += ": 1 yes, 0 no"
    if variable.flags:
        meaning += ": " + ", ".join(f"{value} {word}" for value, word in variable.flags)
    fill = "NaN" if np.isnan(variable.fill_value) else f"{variable.fill_value:g}"
    shape = f"({', '.join(dims)})" if dims else "one number"
    return [f"`{variable.name}`", shape, np.dtype(variable.dtype).name, fill, variable.units, meaning]


def tables_by_condition(rows: Iterable[tuple[str, list[str]]]) -> str:
    """A table for each condition under which variables are stored, first those that are always stored. rows:
    (condition, row) of each variable; the condition "" means always."""
    groups: dict[str, list[list[str]]] = {"": []}
    for condition, row in rows:
        groups.setdefault(condition, []).append(row)
    always = variable_table(groups.pop(""))
    return always + "".join(
        f"\nOnly with {name if name.startswith('diagrams') else f'`{name}`'}:\n\n{variable_table(of)}"
        for name, of in groups.items()
    )


def variable_table(rows: Iterable[Sequence[str]]) -> str:
    return table(("variable", "dimensions", "type", "if missing", "unit", "meaning"), rows)


def whole(task: str, overrides: tuple[str, ...] = ()) -> Job:
    """The job of the task's config in WHOLE."""
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / f"{task}.yaml"
        path.write_text(f"task: {task}\n{textwrap.dedent(WHOLE[task])}\n")
        return job_of_file(path, overrides)


def table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table; a line break in a cell would end its row."""
    lines = [headings, ["---"] * len(headings), *rows]
    cells = ([" ".join(cell.replace("|", r"\|").split()) for cell in line] for line in lines)
    return "".join(f"| {' | '.join(line)} |\n" for line in cells)


def code(names: str) -> str:
    """Each of the names as code."""
    return ", ".join(f"`{name}`" for name in names.split(", "))


def pages() -> dict[Path, str]:
    """Text of every page with tables, by its path."""
    return {DOCS / "file-format.md": text()} | {
        task_path(task): task_page(task) for task in CONFIG_CLASSES_BY_TASK
    }


if __name__ == "__main__":
    for path, whole_text in pages().items():
        path.write_text(whole_text)
