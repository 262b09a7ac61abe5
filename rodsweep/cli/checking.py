"""Output of `rodsweep check`: points, modelled and neglected effects, expected cost."""

from dataclasses import replace
from math import isinf

import numpy as np
from rich.console import Console
from rich.table import Table

from ..config.arm.quantities import quantities_as_typed
from ..config.arm.section import ArmConfig
from ..config.arm.status import SLENDER
from ..discretization.elements.resolution import RESOLUTION_SETTINGS
from ..model.arm.neglected import wall_flattening_effect
from ..post.summary import print_lines
from ..post.summary.arm.validity_sentences import bending_plane_warning, validity_sentence
from ..post.summary.number_texts import value_range_text
from ..sweep.cost_estimate import MAX_SAMPLED_POINTS, with_arm_code_loading_time
from ..sweep.points.points import Points
from ..tasks.arm.arm_points import OutsideModelStatus, numbers_of_distinct_rods
from ..tasks.arm.validity import ArmValidity
from ..tasks.running.job import Job
from ..verdict.checks import tube_flattening_check
from ..wording import count_of_total, counted


@np.errstate(over="ignore")
def print_job_check(job: Job) -> None:
    """Prints the points, the modelled effects and the expected cost of a valid config. For extreme rods the
    arithmetic may overflow, without a warning; the printed estimates remain bounded."""
    console = Console(highlight=False, markup=False)
    console.print(f"{job.config_path}: valid. {job.config.title}".rstrip())
    console.print(job.task.headline_of_check())
    if arms := job.task.arms_line():
        print_lines(console, [arms])
    print_lines(console, _arm_lines(job) if job.quantity_variables else [])
    table = Table("part", "modelled", "why", box=None, pad_edge=False)
    for quantity, is_modelled, reason in job.task.rows_of_check():
        table.add_row(quantity, "yes" if is_modelled else "no", reason)
    console.print(table)
    cost = job.task.cost()
    if not job.config.is_uniform_and_linear:
        cost = with_arm_code_loading_time(cost)
    if cost.unknown_count_range is not None:
        low, high = cost.unknown_count_range
        console.print(f"expected unknowns of the mesh per point: {low} to {high}, for the requested accuracy")
    console.print(
        f"expected cost: {cost.seconds:.3g} s on one rank (divide by the number of ranks; the first run "
        f"may compile for up to three minutes more), {cost.memory_bytes / 1e6:.0f} MB of memory per rank, "
        f"{job.points.count * job.layout.bytes_per_point / 1e6:.3g} MB of results"
    )
    if cost.uncounted_work:
        console.print(f"not counted, because only the run shows them: {cost.uncounted_work}")
    if cost.underestimated_rods:
        console.print(
            f"this estimate is uncertain: {cost.underestimated_rods} may take a hundred times as long, and "
            "more memory; try a single point or row first"
        )
    if cost.too_large_mesh_count:
        sampled = min(MAX_SAMPLED_POINTS, job.points.count)
        console.print(
            f"warning: {cost.too_large_mesh_count} of {sampled} sampled points need a mesh of more than the "
            f"{RESOLUTION_SETTINGS.max_unknowns} unknowns allowed and will end with the status failed; "
            "use a smaller F, fewer modes or a larger number for the accuracy"
        )


def _arm_lines(job: Job) -> list[str]:
    """Lines on an arm: quantities, warnings on walls and plane, parameters, unit of time, points without a
    rod, validity of the model at rest."""
    arm = job.config.parameters.arm
    assert arm is not None
    quantities = {variable.name: np.asarray(values) for variable, values in job.quantity_variables}
    columns = job.points.columns_by_name | {"tau2": quantities["tau2"]}
    texts = (f"{name} = {value_range_text(np.asarray(values))}" for name, values in columns.items())
    at_rest = ArmValidity(job.config, job.points).variables_at_rest()
    load_clause = ", and compression, by the load that it finds"
    if "F" in job.task.coordinates():  # rows along F
        load_clause = ", and compression, by the loads of the rows"
    # The load is known before the run, or the law of rubber includes large compression.
    if "F" in job.points.names or isinf(job.config.rod_material.constitutive_law.crushing_load):
        load_clause = ""
    return [
        f"the arm: {quantities_as_typed(arm.quantity_axes)}{_material_text(arm)}",
        *_thin_wall_warnings(arm),
        *bending_plane_warning(quantities),
        f"the arm as a rod: {', '.join(texts)} s",
        *_lines_on_points_without_rod(job.points),
        f"{validity_sentence(at_rest, condition=' at rest')}; the run also tests inertia, by the frequency "
        f"of the arm's motion{load_clause}",
    ]


def _material_text(arm: ArmConfig) -> str:
    """Text with the segments, the law and the section of an arm, to be appended to the list of quantities."""
    segments_clause = "".join(f"; segment {text}" for text in arm.segments or ())
    laws = [value.replace("_", "-") for value in (arm.law, arm.section and f"{arm.section} section") if value]
    return f"{segments_clause}; {', '.join(laws)}" if laws else segments_clause


def _thin_wall_warnings(arm: ArmConfig) -> list[str]:
    """Warning for tubes with thin walls, in a list; empty if all walls are thick enough."""
    if arm.inner_radius is None:
        return []
    axes = arm.quantity_axes
    sizes = [axes[name].array() for name in ("length", "radius", "inner_radius")]
    of_rubber = np.array([0.5])
    poisson_values = axes["poisson"].array() if "poisson" in axes else of_rubber
    length, radius, inner_radius, poisson = np.meshgrid(*sizes, poisson_values)
    tubes = inner_radius < radius
    effect = wall_flattening_effect(length[tubes], radius[tubes], inner_radius[tubes], poisson[tubes])
    worst_index = int(np.argmax(effect.value))
    warning = tube_flattening_check(replace(effect, value=effect.value[worst_index])).text
    affected_count = int((effect.validity > 0).sum())
    return [f"{warning} Of {counted(effect.value.size, 'tube')} this is the worst."] if affected_count else []


def _lines_on_points_without_rod(points: Points) -> list[str]:
    """Lines with the number of different rods, and with the number of points to which the rod model does not
    apply, by reason."""
    lines = list[str]()
    rods = numbers_of_distinct_rods(points)
    if rods is not None:
        modelled_rods = rods if points.validity_codes is None else rods[points.validity_codes == SLENDER]
        rods_text = counted(len(np.unique(modelled_rods)), "different rod")
        lines.append(f"{rods_text} at {counted(len(modelled_rods), 'point')}; equal rods are solved once")
    for status in OutsideModelStatus:
        point_count = 0 if points.validity_codes is None else int((points.validity_codes == status).sum())
        if point_count:
            lines.append(
                f"{status.name} at {count_of_total(point_count, points.count, 'point')}: {status.sentence}"
            )
    return lines
