"""What each task stores: files as other programs open them, records that fit them, runs that continue."""

import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
import xarray
from contents import content
from faults import small
from surveyed import few

import rodsweep as rs
from rodsweep.discretization.elements.resolution import Resolution
from rodsweep.post.plane_curves import PlaneParameters
from rodsweep.post.summary import POINT_NOUNS, show_summary
from rodsweep.post.summary.cycle_curves import cycle_curve_lines, fold_curve_extremum_lines
from rodsweep.results.file.creation import FilePlan, FinalAdditions
from rodsweep.results.file.result_file_writer import ResultFileWriter
from rodsweep.results.file.view import read_view
from rodsweep.results.layouts.thresholds import CROSSING_KINDS
from rodsweep.results.layouts.variables import Variable
from rodsweep.results.run.journal import Journal
from rodsweep.solve.branch.special.special_curves import CurveEndReason, CurvePoint, SpecialPointCurve
from rodsweep.solve.branch.special.special_point import SpecialPointKind
from rodsweep.solve.changes.status import ThresholdStatus
from rodsweep.solve.continuation.curves_through_seeds import TracedCurves
from rodsweep.solve.spectrum.search import Spectrum
from rodsweep.solve.spectrum.status import SpectrumStatus
from rodsweep.tasks import modes, spectrum, thresholds
from rodsweep.tasks.diagram.curve_variables import fold_and_torus_curve_values, fold_curve_extremum_values
from rodsweep.tasks.running.job import job_of_file
from rodsweep.tasks.thresholds import crossing_values

CONFIGS = {
    "spectrum": "parameters: {F: [1, 2], k1: 9, k2: [1, 2], gamma3: 0}\nspectrum: {modes: 3, vectors: true}",
    "thresholds": "parameters: {k1: [9, .inf], k2: [1, 2, 3], gamma3: 0}\nthresholds: {crossings: 4}",
    "phase_diagram": "parameters: {F: [1, 2, 4], k1: 9, k2: [1, .inf], gamma3: 0}",
    "modes": "parameters: {F: [1, 2], k1: 9, k2: 1, gamma3: 0}\nmodes: {nodes: 5}",
}
SIZES = {
    "spectrum": {"F": 2, "k1": 1, "k2": 2, "gamma3": 1, "mode": 3, "u": 33},
    "thresholds": {"k1": 2, "k2": 3, "gamma3": 1, "crossing": 4},
    "phase_diagram": {"k1": 1, "k2": 2, "gamma3": 1, "F": 3, "crossing": 16},
    "modes": {"F": 2, "k1": 1, "k2": 1, "gamma3": 1, "mode": 2, "u": 5},
}
DIMENSIONS = {
    ("spectrum", "Theta_imag"): ("F", "k1", "k2", "gamma3", "mode", "u"),
    ("thresholds", "F_onset"): ("k1", "k2", "gamma3"),
    ("thresholds", "crossing_F"): ("k1", "k2", "gamma3", "crossing"),
    ("phase_diagram", "class"): ("k1", "k2", "gamma3", "F"),
    ("phase_diagram", "crossing_at"): ("k1", "k2", "gamma3", "crossing"),
    ("modes", "adjoint_Theta_real"): ("F", "k1", "k2", "gamma3", "mode", "u"),
    ("modes", "transient_growth"): ("F", "k1", "k2", "gamma3"),
}
TASKS = list(CONFIGS)
PLANE = PlaneParameters("F", "k1")


def job_of(tmp_path, task, *overrides):
    path = tmp_path / "c.yaml"
    path.write_text(f"task: {task}\n{CONFIGS[task]}\n")
    return job_of_file(path, overrides)


def plan_of(job):
    return FilePlan(
        job.points,
        job.layout,
        job.task.coordinates(),
        job.task.variables_from_config,
        job.resolved_config,
        {"title": "t", "task": job.config.task},
        ((0, "ok"), (5, "failed")),
    )


def crossing(at, kind, unstable):
    return SimpleNamespace(
        value=at, kind=kind, frequency=10 * at, growth_rate=-at, error=1e-12, unstable_after=unstable
    )


def search(index=0, **more):
    """A search that found an onset, a Hopf point, its reverse, and two more; index moves them."""
    kinds = list(enumerate((1, 2, 4, 5, 1)))
    found = tuple(crossing(1.0 + index + i, kind, 2 * (kind == 2)) for i, kind in kinds)
    return SimpleNamespace(
        status=ThresholdStatus.ok,
        thresholds=found,
        hopf_points=found,
        search_result=SimpleNamespace(
            thresholds=found,
            range_of_further_crossings=(np.nan, np.nan),
            is_proved=True,
            determinant_evaluation_count=100,
            eigenvalue_solve_count=7,
            unstable_at_end=0,
        ),
        seconds=0.25,
        end=200.0,
        **more,
    )


def of_spectrum(number, nodes):
    return Spectrum(
        status=SpectrumStatus.ok,
        eigenvalues=np.array([-1 + 2j, -1 - 2j, -5 + 0j][:number]),
        error_estimate=np.full(number, 1e-12),
        unstable_count=0,
        certified=True,
        elements=1,
        order=20,
        seconds=0.25,
        vectors=(np.arange(2 * number * nodes) * (1 + 2j)).reshape(2, number, nodes),
    )


def of_modes(number, nodes):
    spectrum = of_spectrum(number, nodes)
    vectors = SimpleNamespace(
        resolution=Resolution(1, 20),
        right_modes=spectrum.vectors,
        mode_strains=spectrum.vectors + 100,
        left_modes=spectrum.vectors + 200,
        pairing=np.full(number, 2 + 1j),
        condition=np.full(number, 3.0),
        mode_error=np.full(number, 1e-9),
        condition_error=np.full(number, 1e-9),
    )
    growth = SimpleNamespace(
        numerical_abscissa=4.0,
        abscissa_error=1e-9,
        transient_growth=1.5,
        transient_time=0.5,
        growth_error=1e-9,
    )
    return SimpleNamespace(status=0, spectrum=spectrum, mode_vectors=vectors, growth=growth, seconds=0.25)


def record_of(task, index=0):
    if task == "spectrum":
        return spectrum.spectrum_values(of_spectrum(3, 33))
    if task == "modes":
        return modes.mode_values(of_modes(2, 5), growth=True)
    if task == "thresholds":
        return thresholds.threshold_values(search(index), 4)
    row = {"class": [0, 1, 2], "unstable_count": [0, 0, 2]}
    return crossing_values(search(index), 16, "F", "crossing_at") | row


def filled_file(tmp_path, task):
    """The file of a small run in which every point has a record."""
    job = job_of(tmp_path, task)
    store = ResultFileWriter(tmp_path / "c.h5", plan_of(job))
    journal = Journal(store.journal_directory, 0, job.layout, store.plan.fingerprint)
    for index in range(job.points.count):
        journal.append(index, record_of(task, index))
    journal.close()
    store.add_journals({"note": "whole"})
    store.close()
    return tmp_path / "c.h5"


@pytest.mark.parametrize("task", TASKS)
def test_record_of_a_task_has_all_variables_of_its_layout_and_no_other(tmp_path, task):
    assert set(record_of(task)) == {variable.name for variable in job_of(tmp_path, task).layout.variables}


@pytest.mark.parametrize("task", TASKS)
def test_file_of_every_task_opens_in_xarray_with_named_dimensions(tmp_path, task):
    with xarray.open_dataset(filled_file(tmp_path, task), engine="h5netcdf") as data:
        assert dict(data.sizes) == SIZES[task]
        assert set(data.sizes) <= set(data.coords)
        for (owner, name), dims in DIMENSIONS.items():
            if owner == task:
                assert data[name].dims == dims
        assert int(abs(data.status).max()) == 0
        assert all("units" in v.attrs and "long_name" in v.attrs for v in data.variables.values())


def dimensions(data):
    """The names of the dimension scales of an HDF5 dataset; readers guess by size where there are none."""
    return tuple("/".join(dimension.keys()) for dimension in data.dims)


@pytest.mark.parametrize("task", TASKS)
def test_every_variable_has_its_dimension_scales(tmp_path, task):
    with h5py.File(filled_file(tmp_path, task)) as file:
        for name in set(file) - set(SIZES[task]):
            names = dimensions(file[name])
            assert [SIZES[task][n] for n in names] == list(file[name].shape), name
            assert names == DIMENSIONS.get((task, name), names)


@pytest.mark.parametrize("task", TASKS)
def test_words_are_stored_as_flags_with_their_meanings(tmp_path, task):
    flagged = {"thresholds": ["crossing_kind"], "phase_diagram": ["crossing_kind", "class"]}.get(task, [])
    with h5py.File(filled_file(tmp_path, task)) as file:
        assert {n for n in file if "flag_values" in file[n].attrs} == {"status", *flagged}
        for name in flagged:
            a = file[name].attrs
            assert a["flag_values"].dtype == file[name].dtype == np.int8
            meaning = dict(zip(a["flag_values"], a["flag_meanings"].split(), strict=True))
            assert [meaning[i] for i in (1, 2)] == {
                "crossing_kind": ["onset", "hopf"],
                "class": ["oscillatory", "flutter"],
            }[name]


def test_kinds_of_crossings_have_the_numbers_of_the_solver():
    from rodsweep.solve.changes.threshold_kinds import ThresholdKind

    assert {kind.name: int(kind) for kind in ThresholdKind} == {
        name: number for number, name in enumerate(CROSSING_KINDS) if number
    }


def test_classes_of_a_phase_diagram_have_the_numbers_of_the_solver():
    from rodsweep.results.layouts.phase_diagram import STABILITY_CLASSES
    from rodsweep.solve.changes.diagram.rows import StabilityClass

    assert {int(motion): motion.name for motion in StabilityClass} == {
        v: name for v, name in STABILITY_CLASSES if v >= 0
    }


def test_first_crossings_are_stored_and_all_are_counted(tmp_path):
    v = read_view(filled_file(tmp_path, "thresholds")).variables
    assert v["F_onset"].ravel().tolist() == [1, 2, 3, 4, 5, 6]
    assert (v["F_hopf"][0, 0, 0], v["hopf_frequency"][0, 0, 0]) == (2, 20)
    assert (v["F_restabilization"][0, 0, 0], v["restabilization_frequency"][0, 0, 0]) == (3, 30)
    assert v["crossing_F"][0, 0, 0].tolist() == [1, 2, 3, 4]
    assert v["unstable_after"][0, 0, 0].tolist() == [0, 2, 0, 0]
    assert v["crossing_count"].max() == 5


def test_places_without_a_crossing_are_filled():
    nothing = search()
    nothing.thresholds = nothing.search_result.thresholds = ()
    record = thresholds.threshold_values(nothing, 2)
    assert np.isnan([record["F_onset"], record["F_hopf"], *record["crossing_F"]]).all()
    assert record["crossing_kind"] == [0, 0]
    assert record["unstable_after"] == [-1, -1]


def test_transient_growth_is_stored_only_where_it_is_computed(tmp_path):
    with_growth, without = (job_of(tmp_path, "modes", f"modes.growth={g}") for g in ("true", "false"))
    names = [{v.name for v in job.layout.variables} for job in (with_growth, without)]
    assert names[0] - names[1] >= {"numerical_abscissa", "transient_growth", "transient_time"}
    assert set(modes.mode_values(of_modes(2, 5), growth=False)) == names[1]


def test_point_list_of_rods_without_a_force_opens_with_its_coordinates(tmp_path):
    (tmp_path / "p.csv").write_text("k2,k1,gamma3\n1,9,0\n2,inf,0.5\n")
    (tmp_path / "c.yaml").write_text("task: thresholds\nparameters: {points: p.csv}\n")
    ResultFileWriter(tmp_path / "c.h5", plan_of(job_of_file(tmp_path / "c.yaml", ()))).close()
    with xarray.open_dataset(tmp_path / "c.h5", engine="h5netcdf") as data:
        assert data.crossing_F.dims == ("point", "crossing")
        assert set(data.coords) == {"point", "crossing", "k1", "k2", "gamma3"}
        assert data.k1.values.tolist() == [9, np.inf]


@pytest.mark.parametrize("count", [0, 5])
def test_variables_added_when_a_run_ends_have_their_own_dimensions(tmp_path, count):
    path = filled_file(tmp_path, "phase_diagram")
    job = job_of(tmp_path, "phase_diagram")
    store = ResultFileWriter(path, plan_of(job))
    curve = [
        (Variable("curve_number", "<i4", -1, "1", "curve", ("curve_point",)), np.arange(count)),
        (Variable("curve_F", "<f8", np.nan, "k3/L^2", "F", ("curve_point",)), np.arange(count) / 2),
        (Variable("fold_F", "<f8", np.nan, "k3/L^2", "F", ("fold",)), np.array([3.5])),
    ]
    store.finish({"finished": "now"}, FinalAdditions(curve))
    store.close()
    with h5py.File(path) as file:
        assert dimensions(file["curve_F"]) == dimensions(file["curve_number"]) == ("curve_point",)
        assert dimensions(file["fold_F"]) == ("fold",)
    with xarray.open_dataset(path, engine="h5netcdf") as data:
        assert dict(data.sizes) == SIZES["phase_diagram"] | {"curve_point": count, "fold": 1}
        assert data.curve_F.values.tolist() == [i / 2 for i in range(count)]
        assert data.attrs["finished"] == "now"
        assert data["class"].values[0, 0, 0].tolist() == [0, 1, 2]


@pytest.mark.parametrize(
    ("task", "words"),
    {
        "spectrum": [
            "stable at all 4 points",
            "proved at 4 of 4 points",
            "unknowns of the mesh per point: 60",
        ],
        "thresholds": [
            "F** (straight rod starts to flutter): F = 2 (",
            "at all 6 rods; frequency 20 to 70 rad/tau2",
            "at all 6 rods; growth rate -6 to -1 1/tau2",
            "restabilization (straight rod is stable again): F = 3 (",
            "searched up to F = 200 ",
            "the list of crossings is proved complete for 6 of 6 rods",
        ],
        "phase_diagram": [
            "of 6 grid points on the rows: 2 monotone, 2 oscillatory, 2 flutter",
            "absolute error at most 1e-12",
        ],
        "modes": [
            "condition number of the leading eigenvalue: 3",
            "abscissa: 4 1/tau2 largest transient growth: 1.5 times, at t = 0.5000 tau2",
        ],
    }.items(),
    ids=TASKS,
)
def test_show_tells_what_matters_of_every_task(tmp_path, capsys, task, words):
    show_summary(read_view(filled_file(tmp_path, task)))
    text = " ".join(capsys.readouterr().out.split())
    for word in ["ok", f"time per {POINT_NOUNS.get(task, 'point')}: median 250 ms", *words]:
        assert word in text


@pytest.mark.parametrize(
    ("task", "words"),
    {
        "thresholds": [
            "6 points (a grid of 2 x 3 x 1), each searched from F = 0 to 200",
            "at most 4 are stored",
        ],
        "phase_diagram": ["2 rows, one for each k2, of 3 values of F each", "boundaries as curves yes"],
        "modes": [
            "2 points (a grid of 2 x 1 x 1 x 1), 2 leading modes each, on 5 nodes",
            "numerical abscissa yes",
        ],
    }.items(),
    ids=TASKS[1:],
)
def test_check_says_what_every_task_would_compute(command, task, words):
    command.write("c.yaml", f"task: {task}\n{CONFIGS[task]}\n")
    run = command("check", "c.yaml")
    assert run.returncode == 0, run.stderr
    text = " ".join(run.stdout.split())
    for word in ["stretch yes", "rotational drag no gamma3 = 0", "certificate yes", "s on one rank", *words]:
        assert word in text


def test_a_curve_of_one_point_has_the_reasons_of_both_ends():
    point = CurvePoint(
        parameter_value=60.0,
        row_parameter_value=150.0,
        row_coordinate=0.5,
        error=1e-7,
        period=0.02,
        tip_y_max=0.3,
    )
    curve = SpecialPointCurve(
        SpecialPointKind.fold,
        (point,),
        (CurveEndReason.edge, CurveEndReason.not_followed),
        (None, None),
    )
    filled = fold_and_torus_curve_values(
        TracedCurves((curve,), max_seed_distance_per_row_length=0.0, untraced_seed_count=0), PLANE
    )
    view = SimpleNamespace(variables={variable.name: values for variable, values in filled})
    (line,) = cycle_curve_lines(view, PLANE)
    first, last = (
        f"k1 = 150, F = 60.0000000 (+- 1e-07) ({why})"
        for why in ("edge of the diagram", "no further point found")
    )
    assert line.startswith(f"curve of folds of cycles: from {first} to {last}; 1 point,")


def test_an_extremum_of_the_row_parameter_along_a_curve_of_folds_is_stored_and_shown():
    """As with folds at gamma3 = 0.006, where a closed branch of cycles shrinks to one cycle."""
    places = [(74.1, 133.0742), (79.00407, 133.0145143), (110.0, 134.0)]
    points = tuple(
        CurvePoint(
            parameter_value=at,
            row_parameter_value=k1,
            row_coordinate=k1 - 133,
            error=1e-6,
            period=0.02,
            tip_y_max=0.1,
            row_parameter_error_at_extremum=4e-7 if k1 == min(places, key=lambda place: place[1])[1] else 0.0,
        )
        for at, k1 in places
    )
    curves = [SpecialPointCurve(SpecialPointKind.fold, points[2:], (CurveEndReason.edge,) * 2, (None, None))]
    curves.append(replace(curves[0], points=points))
    traced = TracedCurves(tuple(curves), max_seed_distance_per_row_length=0.0, untraced_seed_count=0)
    filled = fold_curve_extremum_values(traced, PLANE)
    view = SimpleNamespace(variables={variable.name: values for variable, values in filled})
    assert {name: values.tolist() for name, values in view.variables.items()} == {
        "cycle_extremum_curve": [2],
        "cycle_extremum_F": [79.00407],
        "cycle_extremum_k1": [133.0145143],
        "cycle_extremum_F_error": [1e-6],
        "cycle_extremum_k1_error": [4e-7],
    }
    (line,) = fold_curve_extremum_lines(view, PLANE)
    assert line.startswith(
        "extremum of k1 along curve 2 of folds of cycles: k1 = 133.0145143 (+- 4e-07), "
        "F = 79.004070 (+- 1e-06); "
    )
    assert fold_curve_extremum_values(replace(traced, curves=(curves[0],)), PLANE) == []
    unlocated = replace(
        curves[0], points=(points[0], replace(points[2], row_parameter_error_at_extremum=np.nan))
    )
    ((variable, count),) = fold_curve_extremum_values(replace(traced, curves=(unlocated,) * 2), PLANE)
    assert (variable.name, int(count)) == ("cycle_extrema_unlocated", 2)
    (line,) = fold_curve_extremum_lines(SimpleNamespace(variables={variable.name: count}), PLANE)
    assert line.startswith("extrema of k1 along curves of folds of cycles that could not be located: 2;")
    assert fold_curve_extremum_lines(SimpleNamespace(variables={}), PLANE) == []


def test_a_row_that_a_curve_of_folds_meets_without_a_fold_of_its_own_is_named():
    points = tuple(
        CurvePoint(
            parameter_value=at,
            row_parameter_value=k1,
            row_coordinate=x,
            error=1e-7,
            period=0.02,
            tip_y_max=0.3,
        )
        for at, k1, x in ((60.0, 150.0, 0.5), (70.0, 200.0, 1.0))
    )
    curve = SpecialPointCurve(SpecialPointKind.fold, points, (CurveEndReason.edge,) * 2, (None, None))
    filled = fold_and_torus_curve_values(
        TracedCurves((curve,), max_seed_distance_per_row_length=0.0, untraced_seed_count=0), PLANE
    )
    nan = float("nan")
    rows = {
        "cycle_special_kind": np.array([[0, 0], [1, 2], [0, 0], [2, 3], [2, 0]]),
        "cycle_special_F": np.array([[nan, nan], [55.0, 60.0], [nan, nan], [75.0, 65.0], [70.0, nan]]),
    }
    view = SimpleNamespace(
        variables={variable.name: values for variable, values in filled} | {"F": np.array([0.0, 100.0])},
        point_columns={"k1": np.array([100.0, 150.0, 160.0, 175.0, 200.0])},
        status_names=np.array(["ok", "ok", "failed", "ok", "ok"]),
        flattened_by_point=rows.__getitem__,
    )
    _, line = cycle_curve_lines(view, PLANE)
    assert line.startswith("this curve crosses the row k1 = 175 between F = 60 and 70, but no branch of")


def test_check_and_show_start_neither_mpi_nor_petsc(tmp_path):
    """For any task: they must work on a login node."""
    code = (
        "import sys\nfrom pathlib import Path\n"
        "from rodsweep.cli.checking import print_job_check\n"
        "from rodsweep.tasks.running.job import job_of_file\n"
        "from rodsweep.post.summary import show_summary\nfrom rodsweep.results.file.view import read_view\n"
        "for place in map(Path, sys.argv[1:]):\n"
        "    print_job_check(job_of_file(place / 'c.yaml', ()))\n"
        "    show_summary(read_view(place / 'c.h5'))\n"
        "    print([m for m in ('mpi4py.MPI', 'petsc4py', 'slepc4py') if m in sys.modules])"
    )
    for task in TASKS:
        (tmp_path / task).mkdir()
        filled_file(tmp_path / task, task)
    argv = [sys.executable, "-c", code, *(str(tmp_path / task) for task in TASKS)]
    run = subprocess.run(argv, capture_output=True, text=True, check=True)
    assert [line for line in run.stdout.splitlines() if line.startswith("[")] == ["[]"] * len(TASKS)


FAKE = """
import os
import rodsweep.solve.changes.thresholds as real
from rodsweep.solve.changes.status import ThresholdStatus
from types import SimpleNamespace as Value

def solve_thresholds(rod, request):
    k1, k2 = rod.k1, rod.k2
    if os.environ.get("DIE_AT") == f"{k1:g}":
        os._exit(9)
    status = ThresholdStatus.list_full if k1 == 14 else ThresholdStatus.ok
    found = (Value(value=k1 / 2, kind=2, frequency=k2, growth_rate=0.0, error=1e-12, unstable_after=2),)
    found = real.ThresholdSearchResult(
        thresholds=found, unstable_at_end=2, is_proved=True, determinant_evaluation_count=3,
        eigenvalue_solve_count=4,
    )
    return real.Thresholds(
        status=status, search_result=found, end=request.F_max, seconds=0.01, message="a message"
    )

real.solve_thresholds = solve_thresholds
real.warm_up = lambda: None
"""


def run_fake(command, *words, **variables):
    return command("run", "c.yaml", *words, patch=FAKE, **variables)


def test_killed_search_for_thresholds_is_continued_to_the_same_file(command):
    command.write(
        "c.yaml", "task: thresholds\nparameters: {k1: {start: 10, stop: 17, num: 8}, k2: [1, 2], gamma3: 0}\n"
    )
    assert run_fake(command, DIE_AT="13").returncode == 9
    assert read_view(command.directory / "c.h5").journalled_count == 6
    again = run_fake(command)
    assert "10 of 16 points to do, 6 kept" in again.stdout, again.stderr
    assert "14 ok, 2 list_full" in again.stdout
    assert "list_full, for example at k1 = 14, k2 = 1, gamma3 = 0: a message" in again.stdout
    assert again.returncode == 1
    assert "raise the option crossings" in " ".join(command("show", "c.h5").stdout.split())
    run_fake(command, "-o", "whole.h5")
    with h5py.File(command.directory / "c.h5") as a, h5py.File(command.directory / "whole.h5") as b:
        assert set(a) == set(b)
        for name in a:
            assert np.array_equal(a[name][...], b[name][...], equal_nan=a[name].dtype.kind == "f"), name
        assert a["F_hopf"][:, 1, 0].tolist() == [k1 / 2 for k1 in range(10, 18)]
    assert "complete, nothing to do" in run_fake(command).stdout


def test_thresholds_of_the_paper_are_found_from_the_command_line(command):
    command.write(
        "c.yaml",
        "task: thresholds\nparameters: {k1: [100, 200], k2: 1.0e4, gamma3: 1.0e-4}\naccuracy: 1e-9\n",
    )
    run = command("run", "c.yaml", ranks=2)
    assert run.returncode == 0, run.stderr
    v = read_view(command.directory / "c.h5").variables
    assert np.allclose(v["F_onset"].ravel(), [27.4058263581943, 22.4709774737663], rtol=1e-9)
    assert np.isnan(v["F_hopf"][0, 0, 0])
    assert v["F_hopf"][1, 0, 0] == pytest.approx(49.7580049161915, rel=1e-9)
    assert v["F_restabilization"][1, 0, 0] == pytest.approx(155.600159298791, rel=1e-9)
    assert v["restabilization_frequency"][1, 0, 0] == pytest.approx(3367.28095760, rel=1e-9)


def test_crossings_beyond_a_full_list_count_as_untraced(command):
    """Their curves may be missing, and the file says so."""
    command.write(
        "c.yaml",
        "task: phase_diagram\nparameters: {F: [0, 150], k1: [170, 200], k2: 1.0e4, gamma3: 1.0e-4}\n",
    )
    untraced = []
    for most in (16, 1):
        words = "--fresh", "--set", f"phase_diagram.crossings={most}"
        assert command("run", "c.yaml", *words).returncode == (most == 1)
        v = read_view(command.directory / "c.h5").variables
        assert v["crossing_count"].ravel().tolist() == [3, 2]  # at k1 = 170 the window closes before 150
        untraced.append(int(v["curves_untraced"]))
    assert untraced == [0, 3]


@pytest.mark.long
@pytest.mark.parametrize("task", few(["limit_cycle", "thresholds", "spectrum", "modes", "phase_diagram"], 2))
def test_a_taper_of_one_that_is_written_changes_nothing(command, task):
    """Also where stability changes between points of a grid, whose lines then have a further parameter."""
    text = small.CONFIGS[task].lstrip()
    command.write("plain.yaml", text)
    command.write("taper.yaml", text.replace("gamma3:", "taper: 1, gamma3:"))
    for name in ("plain", "taper"):
        done = command("run", f"{name}.yaml")
        assert done.returncode == 0, done.stderr
    plain, with_taper = (content(command.directory / f"{name}.h5") for name in ("plain", "taper"))
    assert "taper" in with_taper.keys() - plain.keys() <= {"taper", "hopf_taper"}
    for name, values in plain.items():
        found = with_taper[name].reshape(values.shape)
        assert np.array_equal(found, values, equal_nan=values.dtype.kind == "f"), name


@pytest.mark.parametrize(
    ("F", "rod"),
    [
        ([-10, 10], {"k1": 200, "k2": 10, "gamma3": 1}),
        ([-20, 38.28], {"k1": 7856.848286153369, "k2": 2.1820335055771563, "gamma3": 2.6767801241727e-05}),
        ([-100, 17.77, 57.03], {"k1": 60.02633652773619, "k2": 98.98712508871238, "gamma3": 3.8e-4}),
        ([-100, 94.04], {"k1": 295.9739015462506, "k2": 3485.7553076279214, "gamma3": 4.676964350129872}),
    ],
)
def test_an_onset_between_forces_far_from_each_other_is_located(F, rod):
    """Newton's method alone leaves the interval, or finds eigenvalues that merge behind the leading one."""
    data = rs.sweep("spectrum", F=F, modes=4, progress=False, **rod)
    kinds = [CROSSING_KINDS[kind] for kind in data.change_kind.values]
    (found,) = data.change_F.values[[kind == "onset" for kind in kinds]]
    assert found == pytest.approx(rs.Rod(**rod).thresholds(F_max=50).F_onset, rel=1e-12)


def test_flag_values_have_the_type_of_their_variable():
    """As the CF conventions demand, also of the numbers -1 and 1 of a variable that NaN leaves open."""
    data = rs.sweep("criticality", k1=1e4, k2=1e4, gamma3=1e-4, F_max=40, progress=False)
    flagged = [name for name in data.variables if "flag_values" in data[name].attrs]
    assert {"status", "criticality"} <= set(flagged)
    assert all(data[name].attrs["flag_values"].dtype == data[name].dtype for name in flagged)
