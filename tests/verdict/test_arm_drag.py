"""The range of drags as an axis, and loads relative to flutter: configs, files, `show`, figures of arms."""

import re
import subprocess
import sys

import numpy as np
import pytest
from contents import content, same
from matplotlib.collections import PolyCollection

import rodsweep as rs
from rodsweep.api.keyword_arguments import config_tree, job_of_tree
from rodsweep.config.arm.section import ArmConfig
from rodsweep.config.arm.status import CRUSHED, NO_FLUTTER
from rodsweep.model.arm.arm import SlenderArm
from rodsweep.model.arm.drag import DRAG_ESTIMATE_NAMES
from rodsweep.model.arm.neglected import CURVATURE_OVER_AMPLITUDE, LARGE_AMPLITUDE, wall_flattening_effect
from rodsweep.model.rod import Rod
from rodsweep.post.figures import draw
from rodsweep.results.file.view import read_view
from rodsweep.solve.changes.thresholds import ThresholdsRequest, solve_thresholds
from rodsweep.sweep.points.arm_grid import grid_of_arms
from rodsweep.sweep.points.flutter_forces import FlutterForce
from rodsweep.tasks.arm.arm_points import numbers_of_distinct_rods
from rodsweep.verdict.flutter_over_drags import ThresholdKind
from rodsweep.verdict.relative_load import first_hopf_force, rods_and_force_scales_by_plane

SILICONE = {"length": "14 cm", "radius": "4 mm", "young": "100 kPa", "viscosity": "20 Pa s"}
QUICK = {"accuracy": 1e-3, "harmonics": 2}
OVER_LOADS = """
task: limit_cycle
parameters:
  arm:
    length: [10 cm, 14 cm]
    radius: 4 mm
    young: 100 kPa
    viscosity: 20 Pa s
    drag: [likeliest, most]
    pressure: {start: 0.9 of flutter, stop: 1.3 of flutter, num: 3}
accuracy: 1.0e-3
limit_cycle: {start: neighbour, harmonics: 2}
"""


def test_thresholds_over_the_drags_are_those_of_the_verdict():
    data = rs.sweep("thresholds", arm=SILICONE | {"drag": "range"}, crossings=4)
    arm = rs.Arm(**SILICONE)
    assert data.drag.attrs["flag_meanings"].split() == list(DRAG_ESTIMATE_NAMES)
    assert data.drag.values.tolist() == [0, 1, 2, 3, 4]
    for drag, found in zip(DRAG_ESTIMATE_NAMES, arm.flutter.by_drag, strict=True):
        here = data.sel(drag=DRAG_ESTIMATE_NAMES.index(drag))
        force = found.first_force(ThresholdKind.hopf) * arm.pressure_scale
        assert here.pressure_hopf.item() == pytest.approx(force, rel=1e-9)
        assert here.frequency_hopf_hz.item() == pytest.approx(
            found.first_frequency_hz(ThresholdKind.hopf), rel=1e-9
        )
        assert here.tau2.item() == arm.replace(drag=drag).tau2


def test_cycles_over_the_drags_are_those_of_arms_with_each():
    pressure = "0.9 kPa"
    data = rs.sweep("limit_cycle", arm=SILICONE | {"drag": ["least", "most"], "pressure": pressure}, **QUICK)
    for drag in ("least", "most"):
        alone = rs.Arm(**SILICONE, pressure=pressure, drag=drag).limit_cycle(**QUICK)
        here = data.sel(drag=DRAG_ESTIMATE_NAMES.index(drag))
        assert here.period_si.item() == pytest.approx(alone.period_si, rel=1e-12)
        assert here.gamma1.item() == alone.data.gamma1.item()


def test_a_phase_diagram_has_the_drags_along_gamma3():
    span = {"start": 0, "stop": "1.2 kPa", "num": 4}
    data = rs.sweep("phase_diagram", arm=SILICONE | {"drag": "range", "pressure": span}, curves=False)
    assert data.drag.dims == data.tau2.dims == ("gamma3",)
    assert (np.diff(data.gamma3) > 0).all()
    for place, gamma3, tau2 in zip(data.drag.values, data.gamma3.values, data.tau2.values, strict=True):
        arm = SlenderArm(**SILICONE, drag=DRAG_ESTIMATE_NAMES[place])
        assert (gamma3, tau2) == (arm.gamma3, arm.tau2)
    with pytest.raises(
        rs.InputError, match=r"arm\.pressure is relative to flutter; the axes of a phase diagram"
    ):
        rs.sweep("phase_diagram", arm=SILICONE | {"pressure": "1.2 of flutter"}, gamma3=[1e-3, 2e-3])


def test_a_relative_load_is_that_of_the_verdict_whatever_the_drag():
    shares = ["0.9 of flutter", "20 % above flutter"]
    arm = SILICONE | {"length": ["10 cm", "14 cm"], "drag": ["likeliest", "most"], "pressure": shares}
    data = rs.sweep("spectrum", arm=arm, modes=2)
    assert data.F.dims == ("length", "drag", "pressure_over_flutter")
    assert data.pressure_over_flutter.values.tolist() == [0.9, 1.2]
    for length in (0.1, 0.14):
        known = rs.Arm(**SILICONE | {"length": length}, pressure="1.2 of flutter").loaded
        here = data.sel(length=length, pressure_over_flutter=1.2)
        assert here.pressure.values == pytest.approx(known.si.pressure, rel=1e-9)
        assert here.F.values == pytest.approx(known.F, rel=1e-9)
    assert (data.unstable_count.sel(pressure_over_flutter=0.9) == 0).all()
    assert (data.unstable_count.sel(pressure_over_flutter=1.2) == 2).all()


def test_a_relative_force_is_told_as_a_force():
    arm = SILICONE | {"force": "1.2 of flutter"}
    data = rs.sweep("spectrum", arm=arm, modes=2)
    assert data.force.item() == pytest.approx(rs.Arm(**arm).loaded.si.force, rel=1e-9)
    assert "pressure" not in data.variables


def first_flutter_force(arm):
    return min(first_hopf_force(rod) * scale for rod, scale in rods_and_force_scales_by_plane(arm))


def test_a_rectangle_is_loaded_relative_to_the_plane_that_goes_first():
    arm = {"length": "15 cm", "width": "6 mm", "height": "8 mm", "young": "60 kPa", "viscosity": "40 Pa s"}
    flat, tall = SlenderArm(**arm), SlenderArm(**arm | {"width": "8 mm", "height": "6 mm"})
    assert first_flutter_force(flat) * flat.force_scale == pytest.approx(
        first_flutter_force(tall) * tall.force_scale
    )
    own = Rod(F=0.0, k1=tall.k1, k2=tall.k2, gamma3=tall.gamma3)
    assert first_flutter_force(tall) == first_hopf_force(own)
    data = rs.sweep("spectrum", arm=arm | {"pressure": "1.2 of flutter"}, modes=2)
    known = rs.Arm(**arm, pressure="1.2 of flutter").loaded
    assert data.pressure.item() == pytest.approx(known.si.pressure, rel=1e-9)


VARIED = {
    "cone": {"tip_radius": "2 mm"},
    "rubber": {"law": "neo_hookean", "section": "swelling"},
    "segments": {
        "radius": None,
        "length": None,
        "young": None,
        "segments": ["6 cm: radius 4 mm, young 100 kPa", "8 cm: radius 3 mm, young 80 kPa"],
        "law": "neo_hookean",
    },
}


@pytest.mark.parametrize("kind", VARIED)
def test_a_relative_load_is_one_of_the_arm_as_it_is_built(kind):
    """Just below and just above the threshold that `rodsweep arm` finds by another search."""
    arm = {name: value for name, value in (SILICONE | VARIED[kind]).items() if value is not None}
    given = arm | {"pressure": ["0.9999 of flutter", "1.0001 of flutter"]}
    data = rs.sweep("modes", arm=given, modes=1, nodes=5)
    flutter = rs.Arm(**arm).flutter.by_drag[0].first_force(ThresholdKind.hopf)
    assert data.F.values.ravel() == pytest.approx([0.9999 * flutter, 1.0001 * flutter], rel=2e-6)
    below, above = data.growth_rate.values.ravel()
    assert below < 0 < above


def test_a_law_beside_the_arm_moves_the_flutter_of_relative_loads():
    rubber = {"law": "neo_hookean", "section": "swelling"}
    loaded = SILICONE | {"pressure": "1.2 of flutter"}
    beside = rs.sweep("spectrum", arm=loaded, material=rubber, modes=1)
    own = rs.sweep("spectrum", arm=loaded | rubber, modes=1)
    assert beside.F.item() == own.F.item()
    assert beside.F.item() != pytest.approx(rs.sweep("spectrum", arm=loaded, modes=1).F.item(), rel=1e-3)


def test_a_taper_beside_an_arm_moves_the_flutter_of_relative_loads():
    """Each cone is loaded relative to its own threshold; a taper of 1 to that of the uniform arm."""
    arm = SILICONE | {"pressure": ["0.9999 of flutter", "1.0001 of flutter"]}
    data = rs.sweep("spectrum", arm=arm, taper=[0.5, 1.0], modes=1, certify=False)
    uniform = rs.sweep("spectrum", arm=arm, modes=1, certify=False)
    assert data.growth_rate.dims == ("pressure_over_flutter", "taper", "mode")
    assert data.F.sel(taper=1.0).values == pytest.approx(uniform.F.values, rel=1e-9)
    own = SlenderArm(**SILICONE)
    cone = Rod(F=0.0, k1=own.k1, k2=own.k2, gamma3=own.gamma3, taper=0.5)
    found = solve_thresholds(cone, ThresholdsRequest(40.0, 1e-10, True, 8))
    hopf = next(each.value for each in found.thresholds if each.kind == ThresholdKind.hopf)
    assert data.F.sel(taper=0.5).values == pytest.approx([0.9999 * hopf, 1.0001 * hopf], rel=1e-9)
    assert (np.sign(data.growth_rate[..., 0].values) == [[-1, -1], [1, 1]]).all()


def test_a_taper_beside_an_arm_that_is_no_taper_is_refused_before_flutter_is_searched_for():
    with pytest.raises(rs.InputError, match=r"parameters\.taper = 0 is not allowed"):
        rs.sweep("modes", arm=SILICONE | {"pressure": "1.2 of flutter"}, taper=[0.0, 1.0])


def test_an_arm_without_flutter_is_a_point_with_a_status():
    section = ArmConfig(**SILICONE | {"length": ["10 cm", "14 cm"], "pressure": "1.2 of flutter"})
    stiff = SlenderArm(**SILICONE).k1
    grid = grid_of_arms(
        section, {}, ("F", "k1"), lambda arm, taper: FlutterForce(36.0 if arm.k1 == stiff else np.inf)
    )
    assert grid.validity_codes is not None and grid.validity_codes.tolist() == [NO_FLUTTER, 0]
    assert np.isnan(grid.columns_by_name["F"][0])
    with pytest.raises(ValueError, match="relative to flutter, but with the likeliest drag no arm flutters"):
        grid_of_arms(section, {}, ("F", "k1"), lambda arm, taper: FlutterForce(np.inf))


@pytest.mark.long
def test_shards_ranks_and_an_extension_give_the_same_file(command):
    command.write("a.yaml", OVER_LOADS)
    command.write("less.yaml", OVER_LOADS.replace("[likeliest, most]", "likeliest"))
    assert command("run", "a.yaml", "-o", "whole.h5").returncode == 0
    assert command("run", "a.yaml", "-o", "ranks.h5", ranks=2).returncode == 0
    for shard in (1, 2):
        assert command("run", "a.yaml", "-o", f"{shard}.h5", "--shard", f"{shard}/2").returncode == 0
    assert command("merge", "merged.h5", "1.h5", "2.h5").returncode == 0
    whole = content(command.directory / "whole.h5")
    for name in ("ranks.h5", "merged.h5"):
        assert same(whole, content(command.directory / name))
    assert command("run", "less.yaml", "-o", "less.h5").returncode == 0
    assert "drag" not in rs.open(command.directory / "less.h5").dims


@pytest.mark.long
def test_show_answers_in_the_units_of_the_arm_before_those_without_dimension(command):
    command.write("a.yaml", OVER_LOADS)
    command.solved("a.yaml")
    answer, rest = command("show", "a.h5").stdout.split("\nthe same in dimensionless numbers:\n")
    data = rs.open(command.directory / "a.h5")
    assert not re.search(r"\bF\b|\bk1\b|gamma3|tau2|mHz", answer)
    assert re.search(r"beats at 8 \(length 10 to 14 cm, pressure [\d.]+ to [\d.]+ kPa, 1.1 to 1.3 of", answer)
    assert "of 6 combinations of arm and load: beats for every drag at 4, for no drag at 2" in answer
    frequency = data.frequency_hz.where(np.isfinite(data.period))
    spread = (frequency.max("drag") / frequency.min("drag")).max().item()
    assert 1 < spread < 2  # in percent, then
    stated = re.search(r"frequency by up to (\d+) %", answer)
    assert float(stated[1]) == pytest.approx(100 * (spread - 1), abs=0.5)
    assert "F** (straight rod starts to flutter)" in rest


def test_a_figure_has_a_band_over_the_drags_of_the_file(command, drawn):
    command.write("a.yaml", OVER_LOADS.replace("[10 cm, 14 cm]", "14 cm"))
    command.solved("a.yaml")
    draw(read_view(command.directory / "a.h5"), command.directory / "f.png")
    panel, data = drawn[0].axes[0], rs.open(command.directory / "a.h5")
    band = next(each for each in panel.collections if isinstance(each, PolyCollection))
    beats = data.frequency_hz.sel(pressure_over_flutter=[1.1, 1.3])
    ends = band.get_paths()[0].vertices[:, 1]
    assert (ends.min(), ends.max()) == (beats.min().item(), beats.max().item())
    assert panel.lines[0].get_ydata() == pytest.approx(data.frequency_hz.sel(drag=0), nan_ok=True)
    words = {text.get_text() for text in drawn[0].legends[0].get_texts()}
    assert "range of drag (line: likeliest)" in words


def test_drags_are_words_in_tables_and_in_sections(command):
    command.write("a.yaml", OVER_LOADS)
    command.solved("a.yaml")
    assert command("export", "a.h5", "--columns", "drag,length").returncode == 0
    lines = (command.directory / "a.csv").read_text().splitlines()
    assert set(lines[1:]) == {"likeliest,0.1", "most,0.1", "likeliest,0.14", "most,0.14"}
    assert command.drawn("plot", "a.h5", "-o", "a.png", "--at", "drag=most").returncode == 0
    refused = command.drawn("plot", "a.h5", "-o", "b.png", "--at", "drag=least")
    assert refused.returncode == 2 and "no point there" in refused.stderr
    assert (
        "the drag must be one of likeliest, least,"
        in command.drawn("plot", "a.h5", "-o", "b.png", "--at", "drag=x").stderr
    )


@pytest.mark.parametrize("task", ["thresholds", "limit_cycle"])
def test_a_rod_of_several_points_is_solved_once(task):
    """Along modulus and viscosity the rods are the same bits where the load is relative, or not there."""
    load = {"pressure": ["1.1 of flutter", "1.2 of flutter"]} if task == "limit_cycle" else {}
    more = QUICK | {"start": "neighbour"} if load else {"crossings": 4}
    arm = SILICONE | {"young": ["50 kPa", "70 kPa", "100 kPa"], "viscosity": ["20 Pa s", "33 Pa s"]}
    data = rs.sweep(task, arm=arm | load, **more)
    assert (data.seconds > 0).sum() == (2 if load else 1)
    alone = rs.sweep(task, arm=SILICONE | {"viscosity": "33 Pa s"} | load, **more)
    for name in ("frequency_hz", "tip_y_max_si") if load else ("pressure_hopf", "frequency_hopf_hz"):
        shared = data[name].sel(young=1e5, viscosity=33)
        assert np.array_equal(shared.values.ravel(), alone[name].values.ravel())


def test_points_of_different_rods_are_told_apart():
    lengths = SILICONE | {"length": ["10 cm", "14 cm"]}
    points = [
        job_of_tree(config_tree("thresholds", {"arm": arm})).points
        for arm in (lengths | {"viscosity": ["20 Pa s", "30 Pa s"]}, lengths)
    ]
    assert np.diff(numbers_of_distinct_rods(points[0])).astype(bool).tolist() == [False, True, False]
    assert numbers_of_distinct_rods(points[1]) is None


def test_a_load_that_crushes_the_arm_at_some_points_only_is_no_refusal(command):
    soft = SILICONE | {"young": "1 kPa"}
    loads = ["5 Pa", "9 Pa", "1 kPa", "2 kPa"]
    data = rs.sweep("spectrum", arm=soft | {"pressure": loads}, modes=2)
    assert data.growth_rate.dims[0] == "F"
    assert data.status.values.ravel().tolist() == [0, 0, CRUSHED, CRUSHED]
    assert np.isfinite(data.growth_rate.values.reshape(4, 2)[:2]).all()
    with pytest.raises(rs.InputError, match="crushes the arm"):
        rs.sweep("spectrum", arm=soft | {"pressure": loads[2:]}, modes=2)


def test_check_says_which_units_it_took_and_warns_of_thin_walls(command):
    def told(length, bore, density="0"):
        arm = f"length: {length}, radius: 5 mm, inner_radius: {bore}, young: 100 kPa, viscosity: 20 Pa s"
        arm += f", density_difference: {density}"
        command.write("a.yaml", f"task: thresholds\nparameters: {{arm: {{{arm}}}}}\n")
        return command("check", "a.yaml").stdout

    bare = told(15, "3 mm")
    assert "the arm: length 15 m, young 100 kPa, radius 5 mm" in bare
    assert "density difference 0 kg/m^3 (length without a unit: SI)" in bare
    span = told(15, "3 mm", "{start: 0, stop: 20 kg/m^3, num: 2}")
    assert "density difference 0 to 20 kg/m^3 (length without a unit: SI)" in span
    assert "warning: Wall" not in bare
    thin = told("15 cm", "[3 mm, 4.8 mm]")
    assert "without a unit" not in thin
    assert "warning: Wall: as the tip moves by half the length" in thin
    assert "Of 2 tubes this is the worst" in thin


def test_a_tube_flattens_as_brazier_found():
    """The largest moment of M = E pi r^3 t kappa (1 - loss) is 2 sqrt(2)/9 pi E r t^2/sqrt(1 - nu^2)."""
    r, t, nu = 10.0, 0.01, 0.3
    bend = np.linspace(0, 2e-3, 200001)[1:] / r  # curvatures up to beyond the maximum
    loss = wall_flattening_effect(
        CURVATURE_OVER_AMPLITUDE * LARGE_AMPLITUDE / bend, r + t / 2, r - t / 2, nu
    ).value
    moment = np.pi * r**3 * t * bend * (1 - loss)
    assert moment.max() == pytest.approx(2 * np.sqrt(2) / 9 * np.pi * r * t**2 / np.sqrt(1 - nu**2), rel=1e-6)
    report = str(rs.Arm(**SILICONE, inner_radius="3.6 mm").report())
    assert "warning: Wall: as the tip moves by half the length" in report
    assert "Wall:" not in str(rs.Arm(**SILICONE).report())


@pytest.mark.long
def test_check_of_a_relative_load_and_of_a_tube_starts_no_petsc(tmp_path):
    """As on a login node; on several ranks the first one alone makes the points."""
    tube = OVER_LOADS.replace("radius: 4 mm", "radius: 4 mm\n    inner_radius: 2 mm")
    (tmp_path / "a.yaml").write_text(tube, encoding="utf-8")
    code = (
        "import sys\nfrom pathlib import Path\nfrom rodsweep.cli.checking import print_job_check\n"
        "from rodsweep.tasks.running.job import job_of_file\n"
        "print_job_check(job_of_file(Path(sys.argv[1]), ()))\n"
        "print([m for m in ('mpi4py.MPI', 'petsc4py', 'slepc4py') if m in sys.modules])"
    )
    argv = [sys.executable, "-c", code, str(tmp_path / "a.yaml")]
    assert subprocess.run(argv, capture_output=True, text=True, check=True).stdout.endswith("[]\n")


def test_the_range_of_drag_is_no_drag_of_one_arm():
    with pytest.raises(rs.InputError, match="drag = 'range' is for sweeps over all estimates"):
        rs.Arm(**SILICONE, drag="range").k1  # noqa: B018
