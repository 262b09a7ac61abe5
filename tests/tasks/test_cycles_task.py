"""The task limit_cycle between config and file, with a solver of closed form in place of the real one."""

import subprocess
import sys
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
import xarray
from known_cycles import TORUS, make_view
from ranks import wait_for_end
from surveyed import few

from rodsweep.cli.checking import print_job_check
from rodsweep.errors import InputError
from rodsweep.post.summary import show_summary
from rodsweep.post.summary.limit_cycle import limit_cycle_summary
from rodsweep.post.summary.selection import PointSelection
from rodsweep.results.file.creation import FilePlan
from rodsweep.results.file.result_file_writer import ResultFileWriter
from rodsweep.results.file.view import read_view
from rodsweep.results.run import checkpoints
from rodsweep.results.run.checkpoints import CHECKPOINT_GLOB, Checkpoints
from rodsweep.results.run.journal import Journal, delete_matching_files
from rodsweep.solve.cycle.accuracy.cycle_errors import CycleErrors
from rodsweep.sweep.points.chains import Chains, ChainSolver, SweepChains
from rodsweep.sweep.points.ranges import IndexSet
from rodsweep.sweep.stop import StopRequest
from rodsweep.tasks.running.job import job_of_file

GRID = {"F": "[1, 2]", "k1": "100", "k2": "[10, 20]", "gamma3": "0.5", "gamma1": "[0.5, 1]"}


def config(options="", more="", **axes):
    """The text of a config; an axis that is None is left out."""
    given = ", ".join(f"{name}: {axis}" for name, axis in (GRID | axes).items() if axis is not None)
    return f"task: limit_cycle\nparameters: {{{given}}}\nlimit_cycle: {{{options}}}\n{more}"


def job_of(directory, text, *overrides):
    path = directory / "c.yaml"
    path.write_text(text)
    return job_of_file(path, overrides)


# --- what a config may say --------------------------------------------------------------------------------


def test_options_and_accuracy_have_their_defaults(tmp_path):
    made = job_of(tmp_path, config(gamma1=None)).config
    options = made.limit_cycle
    assert made.accuracy == 1e-7
    assert (options.amplitude, options.most_periods, options.harmonics) == (0.01, 400, 8)
    assert (options.samples, options.shapes, options.nodes, options.time) == (0, 0, 33, "tau2")
    assert (options.start, options.along, options.direction) == ("mode", "longest", "up")


def test_axial_drag_is_an_axis_and_1_where_it_is_not_given(tmp_path):
    points = job_of(tmp_path, config()).points
    assert points.names == ("F", "k1", "k2", "gamma3", "gamma1")
    assert points.shape == (2, 1, 2, 1, 2)
    assert points.parameter_values_of_point(1) == {"F": 1, "k1": 100, "k2": 10, "gamma3": 0.5, "gamma1": 1}
    alone = job_of(tmp_path, config(gamma1=None))
    assert alone.points.columns[4].tolist() == [1]
    assert alone.resolved_config["parameters"]["gamma1"]["values"] == [1]


def test_axial_drag_of_a_spectrum_stays_one_number(tmp_path):
    text = "task: spectrum\nparameters: {F: 1, k1: 9, k2: 1, gamma3: 0, gamma1: 2}\n"
    text += "spectrum: {longitudinal: true}\n"
    made = job_of(tmp_path, text)
    assert made.resolved_config["parameters"]["gamma1"] == 2
    assert made.layout.parameters == ("F", "k1", "k2", "gamma3")
    assert made.config.parameters.constant_parameters == {"gamma1": 2}
    for gamma1, sentence in (("[1, 2]", "gamma1: .*is not a number"), ("-1", "gamma1 = -1 is not allowed")):
        with pytest.raises(InputError, match=sentence):
            job_of(tmp_path, text.replace("gamma1: 2", f"gamma1: {gamma1}"))


def test_point_list_names_all_five_parameters(tmp_path):
    (tmp_path / "p.csv").write_text("gamma1,F,k1,k2,gamma3\n0.5,1,9,8,7\n1,2,9,8,7\n")
    points = job_of(tmp_path, "task: limit_cycle\nparameters: {points: p.csv}\n").points
    assert points.parameter_values_of_point(0) == {"F": 1, "k1": 9, "k2": 8, "gamma3": 7, "gamma1": 0.5}
    for table, sentence in {
        "F,k1,k2,gamma3\n1,9,8,7\n": "it must name F, k1, k2, gamma3 and gamma1",
        "F,k1,k2,gamma3,gamma1\n1,9,8,7,0\n": "line 2: gamma1 = 0.0 is not a finite number above 0",
        "F,k1,k2,gamma3,gamma1\n1,9,8,-1,1\n": "line 2: gamma3 = -1.0 is not a finite number, 0 or above",
        "F,k1,k2,gamma3,gamma1\n9,9,8,1,1\n": "line 2: F = 9.0 is not below k1 = 9.0",
    }.items():
        (tmp_path / "p.csv").write_text(table)
        with pytest.raises(InputError, match=sentence):
            job_of(tmp_path, "task: limit_cycle\nparameters: {points: p.csv}\n")


NEIGHBOUR = "start: neighbour"
REFUSED = [
    (
        config("time: tau1", k2=".inf"),
        "parameters.k2 = inf is not allowed; it must be a finite number, because tau1 = gamma3/k2",
    ),
    (
        config("time: tau1", gamma3="[0, 1]"),
        "parameters.gamma3 = 0 is not allowed; it must be a number above 0, because tau1 = gamma3/k2",
    ),
    (config(gamma1="[0, 1]"), "parameters.gamma1 = 0 is not allowed; it must be a finite number above 0"),
    (config(gamma1=".inf"), "parameters.gamma1 = inf is not allowed; it must be a finite number above 0"),
    (
        config(gamma1="null"),
        "parameters.gamma1 is missing; give F, k1, k2, gamma3 and gamma1, or points: FILE",
    ),
    (config(F="[1, 100]"), "parameters.F reaches 100 and parameters.k1 starts at 100"),
    (config(F=None), "parameters.F is missing; give F, k1, k2, gamma3 and gamma1, or points: FILE.csv"),
    (
        config("amplitude: 0"),
        "limit_cycle.amplitude = 0 is not allowed; it should be a number above 0, at most 1",
    ),
    (
        config("amplitude: 1.5"),
        "limit_cycle.amplitude = 1.5 is not allowed; it should be a number above 0, at",
    ),
    (config("amplitud: 1"), "unknown key limit_cycle.amplitud; did you mean amplitude?"),
    (config("start: next"), "start = 'next' is not allowed; it should be mode, neighbour or hopf"),
    (
        config("start: hopf, amplitude: 0.1"),
        "limit_cycle.amplitude is given but not used; set limit_cycle.start",
    ),
    (
        config("start: hopf, transient: 9"),
        "limit_cycle.transient is given but not used; set limit_cycle.start: mode or remove it",
    ),
    (config("transient: -1"), "limit_cycle.transient = -1 is not allowed; it should be a whole number from"),
    (
        config(f"{NEIGHBOUR}, along: k3"),
        "along = 'k3' is not allowed; it should be F, k1, k2, gamma3, gamma1, taper, pressure, force, "
        "poisson or longest",
    ),
    (config(f"{NEIGHBOUR}, direction: left"), "direction = 'left' is not allowed; it should be up or down"),
    (config("direction: down"), "limit_cycle.direction is given but not used; set limit_cycle.start"),
    (config("along: k1"), "limit_cycle.along is given but not used; set limit_cycle.start: neighbour"),
    (config("nodes: 9"), "limit_cycle.nodes is given but not used; set limit_cycle.shapes or remove it"),
    (config("harmonics: 0"), "limit_cycle.harmonics = 0 is not allowed; it should be a whole number from 1"),
    (config("samples: -1"), "limit_cycle.samples = -1 is not allowed; it should be a whole number from 0"),
    (config("shapes: 1.5"), "limit_cycle.shapes = 1.5 is not allowed; it should be a whole number from 0"),
    (
        config("most_periods: 2"),
        "limit_cycle.most_periods = 2 is not allowed; it should be a whole number from 3 to 1e+06",
    ),
    (
        config("method: integration, most_periods: 15"),
        "limit_cycle.most_periods = 15 is not allowed with method: integration, which needs 16 returns of "
        "the tip for a cycle and its errors; it should be a whole number from 16 to 1e+06",
    ),
    (config("time: tau3"), "limit_cycle.time = 'tau3' is not allowed; it should be tau2 or tau1"),
    (
        config(more="accuracy: 1e-12"),
        "accuracy = 1e-12 is not allowed; it should be a number from 1e-11 to 0.01",
    ),
    (config(more="modes: {}"), "modes is given but the task is limit_cycle; remove it"),
    (config("shapes: 10000, nodes: 513, samples: 100000"), "the results of one point take 0.128 GB"),
    (
        f"task: limit_cycle\nparameters: {{points: p.csv}}\nlimit_cycle: {{{NEIGHBOUR}}}",
        "limit_cycle.start: neighbour needs a grid, in which a point has neighbours",
    ),
    (
        config("start: neighbour, along: taper"),
        "limit_cycle.along is taper but parameters.taper is not given; give several values of it, or set "
        "along to F, k1, k2, gamma3 or gamma1",
    ),
    (
        "task: limit_cycle\nparameters: {points: p.csv, gamma1: 1}",
        "parameters.points and parameters.gamma1 are both given",
    ),
]


def test_neighbours_follow_each_other_along_the_longest_axis(tmp_path):
    for axes, along in (({}, "F"), ({"k2": "[1, 2, 3]"}, "k2"), ({"gamma1": "[1, 2, 3]"}, "gamma1")):
        job = job_of(tmp_path, config(NEIGHBOUR, **axes))
        assert job.config.chain_parameter == along
        assert job.task.chains.axis == job.points.names.index(along)


def test_limits_of_the_rod_are_points_like_others(tmp_path):
    points = job_of(tmp_path, config(k1="[100, .inf]", k2=".inf", gamma3="[0, 1]")).points
    assert points.parameter_values_of_point(0) == {
        "F": 1,
        "k1": 100,
        "k2": np.inf,
        "gamma3": 0,
        "gamma1": 0.5,
    }


@pytest.mark.parametrize(("text", "sentence"), REFUSED, ids=range(len(REFUSED)))
def test_what_the_task_cannot_use_is_refused_in_one_sentence(tmp_path, text, sentence):
    with pytest.raises(InputError) as refusal:
        job_of(tmp_path, text)
    assert sentence in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_check_says_what_is_stored_and_in_which_chains(tmp_path, capsys):
    print_job_check(
        job_of(
            tmp_path,
            config(f"{NEIGHBOUR}, direction: down, samples: 1000, shapes: 50, nodes: 65, transient: 500"),
        )
    )
    text = " ".join(capsys.readouterr().out.split())
    for words in (
        "8 points (a grid of 2 x 1 x 2 x 1 x 2) in 4 chains of 2, down in F: "
        "each starts from its neighbour's cycle",
        "tip deflection 0.01 L",
        "at most 4 ranks can share the work",
        "axial drag yes gamma1 = 0.5, 1",
        "nonlinear motion yes",
        "energy budget yes",
        "1000 per point, 8000 in total: 0.384 MB",
        "50 per point on 65 nodes, 400 in total: 0.624 MB",
        "tip from the start to the cycle yes 500 per point, 4000 in total: 0.128 MB",
        "s on one rank",
    ):
        assert words in text, words
    print_job_check(job_of(tmp_path, config()))
    text = " ".join(capsys.readouterr().out.split())
    for words in (
        "8 points (a grid of 2 x 1 x 2 x 1 x 2), "
        "each started from the leading mode with tip deflection 0.01 L",
        "tip and energy over a cycle no limit_cycle.samples stores them",
        "shapes over a cycle no limit_cycle.shapes stores them",
        "tip from the start to the cycle no limit_cycle.transient stores them",
    ):
        assert words in text, words


# --- the file ---------------------------------------------------------------------------------------------

NUMBERS = (
    "period", "frequency", "linear_growth_rate", "linear_frequency", "tip_x_min", "tip_x_max", "tip_y_max",
    "tip_theta_max", "period_error", "amplitude_error", "extrema_error", "injection_mean", "injection_rms",
    "dissipation_mean", "dissipation_rms", "energy_imbalance", "multiplier", "multiplier_error",
    "trivial_multiplier_error", "modulation_ratio", "least_stretch",
)  # fmt: skip
OF_THE_CYCLE = (
    "linear_growth_rate", "linear_frequency", "multiplier", "trivial_multiplier_error", "modulation_ratio",
)  # fmt: skip
ERRORS = ("period_error", "amplitude_error", "extrema_error", "multiplier_error")
MEASURES = tuple(name for name in NUMBERS if name not in OF_THE_CYCLE + ERRORS)


def cycle(index, harmonics=3, samples=4, shapes=2, nodes=5, transient=6):
    """A cycle whose numbers tell each other apart, as `solve_cycle` gives it."""
    values = {name: float(place + 1) for place, name in enumerate(NUMBERS)}
    return SimpleNamespace(
        **{name: values[name] for name in OF_THE_CYCLE} | {"multiplier": 0.25},
        errors=CycleErrors(**{name: values[name] for name in ERRORS}),
        multipliers=0.25j ** np.arange(1, 7),
        measures=SimpleNamespace(
            **{name: values[name] for name in MEASURES} | {"period": 2.0 + index},
            harmonic_amplitude=np.arange(1.0, harmonics + 1),
        ),
        periods=12 + index,
        second_state=0,
        subcritical_F=np.nan,
        elements=2,
        order=18,
        seconds=0.25,
        status=0,
        message="",
        tip=np.arange(3.0 * samples).reshape(3, samples) if samples else None,
        energy_and_powers=np.arange(3.0 * samples).reshape(3, samples) + 100 if samples else None,
        shape=np.arange(3.0 * shapes * nodes).reshape(3, shapes, nodes) if shapes else None,
        transient_tip_path=np.arange(4.0 * transient).reshape(4, transient) if transient else None,
        neighbour=None,
    )


def nothing(status=1, **sizes):
    """The outcome of a rod without a cycle."""
    found = cycle(0, **sizes)
    for name in vars(found.measures):
        setattr(found.measures, name, np.nan)
    found.errors = CycleErrors(np.nan, np.nan, np.nan, np.nan)
    found.status, found.multiplier, found.trivial_multiplier_error = status, np.nan, np.nan
    found.modulation_ratio = np.nan
    found.tip = found.energy_and_powers = found.shape = found.multipliers = found.transient_tip_path = None
    return found


STORED = "harmonics: 3, samples: 4, shapes: 2, nodes: 5, transient: 6, time: tau1"
WORDS = ("cycle", "straight", "not_settled", "left_the_model", "failed", "unstable", "torus")
FLAGS = tuple(enumerate(WORDS))


def filled_file(directory, text=None):
    """The file of a run whose last point is straight."""
    job = job_of(directory, text or config(STORED))
    attributes = {"title": "t", "task": job.config.task}
    plan = FilePlan(
        job.points, job.layout, job.task.coordinates(), tuple, job.resolved_config, attributes, FLAGS
    )
    store = ResultFileWriter(directory / "c.h5", plan)
    journal = Journal(store.journal_directory, 0, job.layout, plan.fingerprint)
    for index in range(job.points.count):
        outcome = nothing() if index == job.points.count - 1 else cycle(index)
        journal.append(index, job.task.cycle_values(job.points.parameter_values_of_point(index), outcome))
    journal.close()
    store.add_journals({"finished": "now", "started": "before", "ranks": 1})
    store.close()
    return directory / "c.h5"


@pytest.mark.parametrize("options", ["", "samples: 4", "shapes: 2", "transient: 6", "time: tau1", STORED])
def test_record_has_all_variables_of_its_layout_and_no_other(tmp_path, options):
    job = job_of(tmp_path, config(options))
    for outcome in (cycle(0), nothing()):
        assert set(job.task.cycle_values(job.points.parameter_values_of_point(0), outcome)) == {
            v.name for v in job.layout.variables
        }


def test_file_opens_in_xarray_with_named_dimensions(tmp_path):
    points = ("F", "k1", "k2", "gamma3", "gamma1")
    with xarray.open_dataset(filled_file(tmp_path), engine="h5netcdf") as data:
        sizes = dict(zip(points, (2, 1, 2, 1, 2), strict=True))
        sizes |= {"harmonic": 3, "multiplier_number": 6, "sample": 4, "shape": 2, "u": 5, "transient": 6}
        assert dict(data.sizes) == sizes
        assert set(data.sizes) <= set(data.coords)
        assert data.period.dims == points
        assert data.harmonic_amplitude.dims == (*points, "harmonic")
        assert data.tip_theta.dims == data.dissipation.dims == (*points, "sample")
        assert data.shape_y.dims == (*points, "shape", "u")
        assert data.sample.values.tolist() == [0, 0.25, 0.5, 0.75]
        assert data.transient_y.dims == (*points, "transient")
        assert data.transient.values == pytest.approx([0, 0.2, 0.4, 0.6, 0.8, 1])
        assert data.harmonic.values.tolist() == [1, 2, 3]
        assert all("units" in v.attrs and "long_name" in v.attrs for v in data.variables.values())
        second = data.sel(F=1, k1=100, k2=10, gamma3=0.5, gamma1=1)
        assert float(second.period) == 3
        assert float(second.period_tau1) == 3 * 10 / 0.5
        assert second.multiplier_real.values[1] == -(0.25**2)
        assert second.multiplier_imag.values[0] == 0.25
        assert second.tip_y.values.tolist() == [4, 5, 6, 7]
        assert second.injection.values.tolist() == [104, 105, 106, 107]
        assert second.shape_theta.values.tolist() == np.arange(20.0, 30).reshape(2, 5).tolist()
        assert second.transient_time.values.tolist() == [0, 1, 2, 3, 4, 5]
        assert second.transient_theta.values.tolist() == [18, 19, 20, 21, 22, 23]
        last = data.sel(F=2, k1=100, k2=20, gamma3=0.5, gamma1=1)
        assert int(last.status) == 1
        assert np.isnan(last.period_tau1)
        assert np.isnan(last.tip_x).all()
        assert np.isnan(last.transient_x).all()


def test_every_variable_has_its_dimension_scales(tmp_path):
    with h5py.File(filled_file(tmp_path)) as file:
        scales = {
            "F": 2,
            "k1": 1,
            "k2": 2,
            "gamma3": 1,
            "gamma1": 2,
            "harmonic": 3,
            "multiplier_number": 6,
            "sample": 4,
            "shape": 2,
            "u": 5,
            "transient": 6,
        }
        for name in set(file) - set(scales):
            names = ["/".join(dimension.keys()) for dimension in file[name].dims]
            assert [scales[n] for n in names] == list(file[name].shape), name
        assert file["status"].attrs["flag_meanings"].split()[1:] == [word for _, word in FLAGS]


def test_point_list_opens_with_its_parameters_as_coordinates(tmp_path):
    (tmp_path / "p.csv").write_text("F,k1,k2,gamma3,gamma1\n1,9,8,7,0.5\n2,9,8,7,1\n")
    path = filled_file(
        tmp_path, f"task: limit_cycle\nparameters: {{points: p.csv}}\nlimit_cycle: {{{STORED}}}"
    )
    with xarray.open_dataset(path, engine="h5netcdf") as data:
        assert data.shape_x.dims == ("point", "shape", "u")
        assert {"F", "k1", "k2", "gamma3", "gamma1", "point"} <= set(data.coords)
        assert data.gamma1.values.tolist() == [0.5, 1]
    assert read_view(path).parameter_values["gamma1"].tolist() == [0.5, 1]


def test_nothing_is_stored_over_a_cycle_that_was_not_asked_for(tmp_path):
    names = {v.name for v in job_of(tmp_path, config()).layout.variables}
    assert not names & {"tip_x", "energy", "injection", "shape_x", "period_tau1", "transient_x"}
    assert {"tip_x_min", "injection_mean", "harmonic_amplitude"} <= names


def test_show_tells_ranges_and_worst_errors(tmp_path, capsys):
    show_summary(read_view(filled_file(tmp_path)))
    text = " ".join(capsys.readouterr().out.split())
    for words in (
        "gamma1 2 0.5 1 gamma2",
        "of 8 points: beats at 7 (",
        "period: 2 to 8 tau2; largest y of the tip: 7 L",
        "period: 40 to 300 tau1",
        "largest |Floquet multiplier|: 0.2; returns of the tip",
        "worst errors: period 9e+00, largest y of the tip 1e+01, other extrema of the tip 2e+01",
        "energy balance 2e+01",
    ):
        assert words in text, words


def test_show_tells_the_multipliers_of_the_cycles_that_tori_surround():
    view = make_view(([50.0, 60.0], [1e4], [1e2], [1e-2], [1.0]), [1, TORUS])
    view.variables["modulation_ratio"] = np.array([np.nan, 0.170391]).reshape(view.variables["status"].shape)
    view.variables["multiplier"] = np.array([np.nan, 1.25]).reshape(view.variables["status"].shape)
    view.variables["multiplier_error"] = np.full(view.variables["status"].shape, 1e-3)
    told = limit_cycle_summary(PointSelection(view, view.variables["status"] >= 0))
    assert (
        told.answer[0] == "of 2 points: stays straight at 1 (F = 50), "
        "beats quasiperiodically (two frequencies) at 1 (F = 60)"
    )
    modulation = "modulated at 0.170 times the frequency of the oscillation"
    inside = "the unstable cycles inside the tori have a largest |Floquet multiplier| of 1.25"
    assert f"quasiperiodic motions: {modulation}; {inside}" in told.details


def test_check_and_show_start_neither_mpi_nor_petsc(tmp_path):
    file = filled_file(tmp_path)
    code = (
        "import sys\nfrom pathlib import Path\n"
        "from rodsweep.cli.checking import print_job_check\n"
        "from rodsweep.tasks.running.job import job_of_file\n"
        "from rodsweep.post.summary import show_summary\nfrom rodsweep.results.file.view import read_view\n"
        "print_job_check(job_of_file(Path(sys.argv[1]), ()))\nshow_summary(read_view(Path(sys.argv[2])))\n"
        "print([m for m in ('mpi4py.MPI', 'petsc4py', 'slepc4py') if m in sys.modules])"
    )
    argv = [sys.executable, "-c", code, str(tmp_path / "c.yaml"), str(file)]
    run = subprocess.run(argv, capture_output=True, text=True, check=True)
    assert run.stdout.splitlines()[-1] == "[]"


# --- chains -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("upward", [True, False])
def test_chains_hold_every_point_once_in_order_along_their_axis(axis, upward):
    chains = Chains((2, 3, 4), axis, upward)
    assert (chains.points_per_chain, chains.count) == ((2, 3, 4)[axis], 24 // (2, 3, 4)[axis])
    lines = [chains.indices(chain) for chain in range(chains.count)]
    assert sorted(np.concatenate(lines)) == list(range(24))
    for line in lines:
        places = np.array(np.unravel_index(line, chains.shape))
        assert np.diff(places[axis]).tolist() == [1 if upward else -1] * (chains.points_per_chain - 1)
        assert not np.diff(np.delete(places, axis, axis=0)).any()


def test_chains_that_miss_a_point_are_to_be_done():
    chains = Chains((3, 4), 0, True)
    assert chains.unsolved_ranges(IndexSet([(0, 12)])) == [(0, 4)]
    assert chains.unsolved_ranges(IndexSet([(4, 5), (10, 11)])) == [(0, 1), (2, 3)]
    assert chains.unsolved_ranges(IndexSet([])) == []


class Count:
    """A state: a number, or an array of any shape."""

    def __init__(self, value):
        self.value = np.asarray(value)

    def arrays(self):
        return {"index": self.value}

    @classmethod
    def from_arrays(cls, arrays):
        return cls(arrays["index"])


class Kept:
    """Checkpoints in memory."""

    def __init__(self):
        self.of = {}

    def write(self, chain, index, state):
        self.of[chain] = (index, state)

    def read(self, chain):
        return self.of.get(chain)

    def remove(self, chain):
        self.of.pop(chain, None)


def chain_solver(missing, kept, solved, stop=None):
    """Solves chains of six points: an outcome is (index, what it started from); the state counts on."""

    def solve_from(index, state):
        solved.append(index)
        outcome = (index, None if state is None else float(state.value))
        return outcome, Count(0.0 if state is None else state.value + 1)

    stop = StopRequest() if stop is None else stop
    work = SweepChains(Chains((6,), 0, True), solve_from, Count.from_arrays)
    return ChainSolver(work, IndexSet(missing), kept, stop)


@pytest.mark.parametrize("points", range(1, 6))
def test_stopped_chain_goes_on_with_the_next_point(points):
    whole = [outcome for _, outcome in chain_solver([(0, 6)], Kept(), [])(0)]
    kept, stop, done = Kept(), StopRequest(), []
    for _, outcome in chain_solver([(0, 6)], kept, [], stop)(0):
        done.append(outcome)
        if len(done) == points:
            stop.adopt_request_of_rank("SIGUSR1")
    assert done == whole[:points]
    solved = []
    rest = [outcome for _, outcome in chain_solver([(points, 6)], kept, solved)(0)]
    assert done + rest == whole
    assert solved == [*range(points, 6)]


@pytest.mark.parametrize("points", range(1, 6))
@pytest.mark.parametrize("checkpoint_written", [True, False])
def test_killed_chain_goes_on_with_the_state_of_its_neighbour(points, checkpoint_written):
    """Killed right after a point was journalled, before or after its checkpoint was written."""
    whole = [outcome for _, outcome in chain_solver([(0, 6)], Kept(), [])(0)]
    kept = Kept()
    work = chain_solver([(0, 6)], kept, [])(0)
    done = [next(work)[1] for _ in range(points)]
    if checkpoint_written and points < 6:
        next(work)  # the point in flight, which the kill loses
    solved = []
    rest = [outcome for _, outcome in chain_solver([(points, 6)], kept, solved)(0)]
    assert done + rest == whole
    assert solved == list(range(points if checkpoint_written else points - 1, 6))
    assert not kept.of


@pytest.mark.parametrize("missing", [[(0, 6)], [(2, 3), (5, 6)]])
def test_checkpoint_behind_a_missing_point_is_not_used(missing):
    """Records can be lost that a later checkpoint builds upon; the chain then starts again."""
    kept = Kept()
    kept.write(0, 3, Count(7.0))
    outcomes = dict(chain_solver(missing, kept, [])(0))
    assert outcomes == {i: (i, i - 1.0 if i else None) for a, b in missing for i in range(a, b)}


@pytest.mark.parametrize("state", [None, np.array([]), np.arange(6.0).reshape(2, 3) / 7])
def test_checkpoint_is_read_back_exactly(tmp_path, state):
    """Also where the state has an array that is called as one of the checkpoint's own."""
    kept = Checkpoints(tmp_path, "print", Count.from_arrays)
    assert kept.read(3) is None
    kept.write(3, 1, Count(np.zeros(2)))
    kept.write(3, 2**40, None if state is None else Count(state))
    index, found = kept.read(3)
    assert index == 2**40
    assert (found is None) == (state is None)
    assert state is None or (found.value.shape, found.value.tobytes()) == (state.shape, state.tobytes())
    assert Checkpoints(tmp_path, "another", Count.from_arrays).read(3) is None
    assert kept.read(4) is None
    assert len(list(tmp_path.iterdir())) == 1
    kept.remove(3)
    kept.remove(3)
    assert not list(tmp_path.iterdir())


def test_damaged_checkpoint_counts_as_none(tmp_path):
    kept = Checkpoints(tmp_path, "print", Count.from_arrays)
    kept.write(0, 5, Count(np.arange(3.0)))
    (path,) = tmp_path.iterdir()
    data = path.read_bytes()
    for cut in range(len(data)):
        path.write_bytes(data[:cut])
        assert kept.read(0) is None
    for place in range(0, len(data), 7):
        path.write_bytes(data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :])
        assert kept.read(0) is None
    delete_matching_files(tmp_path, CHECKPOINT_GLOB)
    assert not list(tmp_path.iterdir())


def test_checkpoint_whose_states_held_other_numbers_counts_as_none(tmp_path, monkeypatch):
    with monkeypatch.context() as earlier:
        earlier.setattr(checkpoints, "CHECKPOINT_HEAD", b"rodsweep checkpoint 1\n")
        Checkpoints(tmp_path, "print", Count.from_arrays).write(0, 5, Count(np.arange(3.0)))
        assert Checkpoints(tmp_path, "print", Count.from_arrays).read(0) is not None
    assert Checkpoints(tmp_path, "print", Count.from_arrays).read(0) is None


# --- runs -------------------------------------------------------------------------------------------------

FAKE = '''
"""rodsweep.solve.cycle.limit_cycle without PETSc: what a point gives depends on what it started from."""

import os, sys, time
from dataclasses import dataclass
from enum import IntEnum
from types import ModuleType, SimpleNamespace

@dataclass
class Errors:
    period_error: float
    amplitude_error: float
    extrema_error: float
    multiplier_error: float

class CycleStart:
    def __init__(self, *values):
        self.values = values

    def arrays(self):
        import numpy as np
        return {"values": np.array(self.values)}

    @classmethod
    def from_arrays(cls, arrays):
        return cls(*map(float, arrays["values"]))

class CycleStatus(IntEnum):
    cycle, straight, not_settled, left_the_model, failed, unstable = range(6)

    @property
    def sentence(self):
        return f"this is {self.name}"

    @property
    def succeeded(self):
        return self <= CycleStatus.straight

def solve_cycle(point, request, start=None, parameter=None, workspace=None):
    import numpy as np
    F, k2 = point.F, point.k2
    if os.environ.get("DIE_AT") == f"{F:g} {k2:g}":
        os._exit(9)
    open("solved", "a").write(f"{F:g} {k2:g}\\n")
    time.sleep(0.01)
    status = CycleStatus.straight if F == 5 else CycleStatus.cycle
    if F == float(os.environ.get("FAIL_AT", "nan")):
        status = CycleStatus.failed
    memory = 0.5 if start is None else np.sin(sum(start.values)) + k2
    period = memory / 3 + F
    names = ("tip_x_min tip_x_max tip_y_max tip_theta_max injection_mean injection_rms dissipation_mean "
             "dissipation_rms energy_imbalance least_stretch").split()
    amplitudes = np.full(request.harmonics, F)
    measures = SimpleNamespace(
        **dict.fromkeys(names, memory), period=period, frequency=1 / period, harmonic_amplitude=amplitudes
    )
    errors = Errors(memory, memory, memory, memory)
    return SimpleNamespace(
        linear_growth_rate=memory, linear_frequency=memory, multiplier=memory, multipliers=None,
        trivial_multiplier_error=memory, modulation_ratio=memory,
        status=status, measures=measures, errors=errors, periods=3,
        second_state=0, subcritical_F=float("nan"),
        elements=1, order=18, seconds=0.01, message="a message", tip=None, energy_and_powers=None, shape=None,
        start_for_next_rod=CycleStart(memory, F, k2),
    )

fake = ModuleType("rodsweep.solve.cycle.limit_cycle")
fake.CycleStatus, fake.CycleStart, fake.solve_cycle = CycleStatus, CycleStart, solve_cycle
fake.CycleRequest = fake.Rod = SimpleNamespace
sys.modules[fake.__name__] = fake
reference = ModuleType("rodsweep.solve.cycle.rod_with_known_cycle")
reference.warm_up = lambda: None
sys.modules[reference.__name__] = reference
'''


def run_fake(command, *words, ranks=0, **variables):
    return command("run", "c.yaml", *words, ranks=ranks, patch=FAKE, **variables)


def solved(command):
    """(F, k2) of the points solved since this was last asked, in order."""
    path = command.directory / "solved"
    lines = path.read_text().splitlines()
    path.unlink()
    return [tuple(map(float, line.split())) for line in lines]


def content(path):
    """All variables of a file, as bytes, but the time they took."""
    with h5py.File(path) as file:
        return {name: file[name][...].tobytes() for name in file if name != "seconds"}


CHAINS = config(NEIGHBOUR, F="{start: 1, stop: 9, num: 9}", k2="[10, 20, 30]", gamma1=None)


@pytest.mark.parametrize("direction", ["up", "down"])
def test_points_of_a_chain_start_from_their_neighbour(command, direction):
    """F = 5 has no cycle, so the point after it starts from the mode, as the first of a chain does."""
    command.write("c.yaml", CHAINS)
    run = run_fake(command, "--set", f"limit_cycle.direction={direction}")
    assert run.returncode == 0, run.stderr
    forces = list(range(1, 10))[:: 1 if direction == "up" else -1]
    assert solved(command) == [(F, k2) for k2 in (10, 20, 30) for F in forces]
    with h5py.File(command.directory / "c.h5") as file:
        for j, k2 in enumerate((10, 20, 30)):
            state = None
            for F in forces:
                memory = 0.5 if state is None else np.sin(state) + k2
                assert file["period"][F - 1, 0, j, 0, 0] == pytest.approx(memory / 3 + F, rel=1e-14)
                state = None if F == 5 else memory + F + k2
    assert not (command.directory / "c.h5.journal").exists()


def test_chains_may_run_along_any_parameter(command):
    command.write("c.yaml", CHAINS)
    run = run_fake(command, "--set", "limit_cycle.along=k2", "--set", "limit_cycle.direction=down")
    assert run.returncode == 0, run.stderr
    assert solved(command) == [(F, k2) for F in range(1, 10) for k2 in (30, 20, 10)]


def test_points_without_chains_start_from_the_mode(command):
    command.write("c.yaml", CHAINS.replace("neighbour", "mode"))
    assert run_fake(command, ranks=2).returncode == 0
    with h5py.File(command.directory / "c.h5") as file:
        assert np.all(file["tip_y_max"][...] == 0.5)


@pytest.mark.long
@pytest.mark.parametrize(("ranks", "direction"), few([(2, "down"), (0, "up")], 1))
def test_resume_in_the_middle_of_a_chain_gives_the_same_file(command, ranks, direction):
    command.write("c.yaml", CHAINS)
    words = ("--set", f"limit_cycle.direction={direction}")
    assert run_fake(command, *words, "-o", "whole.h5").returncode == 0
    solved(command)
    killed = run_fake(command, *words, DIE_AT="4 20", ranks=ranks)
    assert killed.returncode not in (0, 1, 2)
    wait_for_end(command.directory)
    journalled = read_view(command.directory / "c.h5").journalled_count
    assert 3 <= journalled < 27
    before = solved(command)
    assert journalled in range(len(before) - max(ranks, 1), len(before) + 1)
    again = run_fake(command, *words, ranks=ranks)
    assert again.returncode == 0, again.stderr
    assert f"{27 - journalled} of 27 points to do, {journalled} kept" in again.stdout
    after = solved(command)
    assert (4, 20) in after
    first = 5 if direction == "down" else 3
    assert (first, 20) not in after
    assert len(set(before) & set(after)) <= max(ranks, 1)
    assert content(command.directory / "c.h5") == content(command.directory / "whole.h5")
    assert not (command.directory / "c.h5.journal").exists()
    assert "complete, nothing to do" in run_fake(command, *words).stdout


def test_chain_without_its_checkpoint_is_solved_again_to_the_same_file(command):
    command.write("c.yaml", CHAINS)
    run_fake(command, "-o", "whole.h5")
    run_fake(command, DIE_AT="8 20")
    checkpoint = command.directory / "c.h5.journal" / "chain-000000001"
    checkpoint.write_bytes(checkpoint.read_bytes()[:-1])
    solved(command)
    again = run_fake(command)
    assert "11 of 27 points to do, 16 kept" in again.stdout, again.stderr
    assert "11 points in" in again.stdout
    assert len(solved(command)) == 18
    assert content(command.directory / "c.h5") == content(command.directory / "whole.h5")


def test_fresh_run_does_not_use_old_checkpoints(command):
    command.write("c.yaml", CHAINS)
    run_fake(command, DIE_AT="8 20")
    solved(command)
    before = sorted((command.directory / "c.h5.journal").glob("chain-*"))
    assert [path.name for path in before] == ["chain-000000001"]
    run_fake(command, "--fresh", DIE_AT="1 10")
    assert not any(path.exists() for path in before)
    assert run_fake(command, "--fresh").returncode == 0
    assert len(solved(command)) == 27
    assert not (command.directory / "c.h5.journal").exists()


@pytest.mark.parametrize(("ranks", "start"), few([(3, "neighbour"), (2, "mode")], 1))
def test_any_number_of_ranks_gives_the_same_file(command, ranks, start):
    command.write("c.yaml", CHAINS.replace("neighbour", start))
    assert run_fake(command, "-o", "alone.h5").returncode == 0
    solved(command)
    many = run_fake(command, ranks=ranks)
    assert many.returncode == 0, many.stderr
    assert sorted(solved(command)) == [(F, k2) for F in range(1, 10) for k2 in (10, 20, 30)]
    assert content(command.directory / "c.h5") == content(command.directory / "alone.h5")
    with h5py.File(command.directory / "c.h5") as file:
        assert file.attrs["ranks"] == ranks


def test_straight_rods_are_no_failure_and_failed_ones_are(command):
    command.write("c.yaml", CHAINS)
    run = run_fake(command)
    assert run.returncode == 0, run.stderr
    assert "24 cycle, 3 straight" in run.stdout
    assert "says what each status means" not in run.stdout
    assert "a message" not in run.stdout
    failed = run_fake(command, "-o", "failed.h5", FAIL_AT="7")
    assert failed.returncode == 1
    assert "21 cycle, 3 straight, 3 failed" in failed.stdout
    assert (
        "failed, for example at F = 7, k1 = 100, k2 = 10, gamma3 = 0.5, gamma1 = 1: a message"
        in failed.stdout
    )
    assert "says what each status means" in failed.stdout
    assert "this is failed" in " ".join(command("show", "failed.h5").stdout.split())


def test_statuses_of_the_other_tasks_succeed_when_they_are_ok():
    from rodsweep.solve.changes.status import ThresholdStatus
    from rodsweep.solve.spectrum.status import SpectrumStatus

    for kind in (SpectrumStatus, ThresholdStatus):
        assert [status.name for status in kind if status.succeeded] == ["ok"]


def test_statuses_of_a_cycle_are_those_of_the_file():
    from rodsweep.solve.cycle.status import CycleStatus

    assert tuple((int(status), status.name) for status in CycleStatus) == FLAGS
    assert [s.name for s in CycleStatus if s.succeeded] == ["cycle", "straight", "unstable", "torus"]
