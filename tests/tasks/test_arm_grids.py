"""Grids over an arm's own quantities: axes in files and Datasets, points without a rod, resume and merge."""

import re
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from contents import content, same
from surveyed import few

import rodsweep as rs
from rodsweep.api.dataset import view_of_dataset
from rodsweep.api.keyword_arguments import config_tree, job_of_tree
from rodsweep.config.arm.status import CRUSHED, NO_WALL, NOT_SLENDER
from rodsweep.model.arm.arm import SlenderArm
from rodsweep.model.arm.neglected import Validity
from rodsweep.post.figures.grid_slices import slice_at_values
from rodsweep.results.file.view import read_view

ROOT = Path(__file__).parents[2]
GLYCEROL = {"radius": "5 mm", "young": "100 kPa", "viscosity": "1.4 Pa s"}
TALL = GLYCEROL | {"length": ["4 cm", "10 cm", "12 cm"]}
"""The first of which is shorter than ten radii."""
CONFIG = """
task: spectrum
parameters:
  arm:
    length: [4 cm, 10 cm, 11 cm]
    radius: 5 mm
    young: [1 kPa, 100 kPa]
    viscosity: 1.4 Pa s
    pressure: {start: 0.1 kPa, stop: 1.2 kPa, num: 12}
spectrum: {modes: 2}
"""
"""A grid of 3 x 2 x 12 arms: a third are too short, and the soft ones are crushed from 1 kPa on."""
CHAINS = """
task: limit_cycle
parameters:
  arm:
    length: [4 cm, 10 cm, 11 cm]
    radius: 5 mm
    young: 100 kPa
    viscosity: 1.4 Pa s
    pressure: [2.3 kPa, 2.4 kPa, 2.5 kPa]
accuracy: 1.0e-3
limit_cycle: {start: neighbour, harmonics: 2}
"""


def job(task, **keywords):
    return job_of_tree(config_tree(task, keywords))


@pytest.fixture(scope="module")
def thresholds():
    return rs.sweep("thresholds", arm=TALL | {"young": ["50 kPa", "100 kPa"]}, crossings=8)


def test_values_are_selected_by_the_quantities_in_si(thresholds):
    data = thresholds
    assert data.F_hopf.dims == ("length", "young")
    arm = SlenderArm(length=0.12, radius=0.005, young=1e5, viscosity=1.4, pressure=0)
    alone = rs.Rod(k1=arm.k1, k2=arm.k2, gamma3=arm.gamma3).thresholds()
    here = data.sel(length=0.12, young=1e5)
    assert here.F_hopf.item() == alone.F_hopf
    assert here.k1.item() == pytest.approx(arm.k1, rel=1e-12)
    assert here.pressure_hopf.item() == pytest.approx(alone.F_hopf * arm.force_scale / arm.cross_section.area)
    assert here.pressure_hopf.units == "Pa"
    hertz = here.hopf_frequency / (2 * np.pi * here.tau2)
    assert here.frequency_hopf_hz.item() == pytest.approx(hertz.item(), rel=1e-12)
    assert data.length.attrs == {"units": "m", "long_name": "length of the arm", "typed_unit": "cm"}
    assert data.young.typed_unit == "kPa"


def test_a_section_has_the_points_of_a_quantity_in_any_unit(thresholds):
    view = view_of_dataset(thresholds, Path("arm.h5"))
    for length in ("10 cm", "100 mm", 0.1):
        cut = slice_at_values(view, {"length": length, "young": "0.1 MPa"})
        assert cut.variables["F_hopf"].tolist() == [[thresholds.F_hopf.sel(length=0.1, young=1e5).item()]]
    with pytest.raises(rs.InputError, match=r"has no point there; it has length = 0\.04, 0\.1, 0\.12"):
        slice_at_values(view, {"length": "11 cm"})


def test_a_section_has_the_points_of_a_load_along_F():
    arm = GLYCEROL | {"length": "10 cm", "force": ["10 mN", "20 mN", "30 mN"]}
    view = view_of_dataset(rs.sweep("spectrum", arm=arm, modes=1), Path("arm.h5"))
    cut = slice_at_values(view, {"force": "20 mN"})
    assert cut.variables["force"].tolist() == [0.02]
    assert cut.variables["F"].tolist() == view.variables["F"][1:2].tolist()
    assert cut.variables["growth_rate"].shape[0] == 1
    for at, sentence in (
        ({"force": "25 mN"}, r"has no point there; it has force = 0\.01, 0\.02, 0\.03"),
        ({"pressure": "2 kPa"}, "has no such axis; the points differ in F, force$"),
    ):
        with pytest.raises(rs.InputError, match=sentence):
            slice_at_values(view, at)


def test_hopf_points_of_an_arm_with_a_force_are_forces():
    arm = GLYCEROL | {"length": "10 cm", "force": ["0.15 N", "0.2 N"]}
    data = rs.sweep("limit_cycle", arm=arm, accuracy=1e-3)
    table = rs.table(data, "hopf_points")
    assert "hopf_pressure" not in table
    assert table.hopf_force.tolist() == pytest.approx((data.hopf_F * data.force_scale).values, rel=1e-12)


def test_show_states_flutter_as_a_force_too(command):
    """The cone of the thinner tip flutters at the larger pressure and at the smaller force."""
    arm = "{length: 10 cm, radius: 5 mm, young: 100 kPa, viscosity: 10 Pa s, tip_radius: [4 mm, 5 mm]}"
    command.write("a.yaml", f"task: thresholds\nparameters: {{arm: {arm}}}\n")
    command.solved("a.yaml")
    lines = command("show", "a.h5").stdout.splitlines()
    assert "smallest flutter load at tip radius 5 mm; largest at tip radius 4 mm" in lines
    (line,) = [line for line in lines if line.startswith("flutter as a force at the tip: ")]
    found = re.fullmatch(
        r"flutter as a force at the tip: ([0-9.]+) to ([0-9.]+) N, "
        "smallest at tip radius 4 mm; largest at tip radius 5 mm",
        line,
    )
    data = rs.open(command.directory / "a.h5")
    faces = np.pi * data.tip_radius**2
    assert [float(each) for each in found.groups()] == pytest.approx(
        (data.pressure_hopf * faces).values.tolist(), rel=5e-3
    )


def test_thresholds_over_quantities_of_arms_share_no_figure(thresholds, tmp_path):
    with pytest.raises(rs.InputError, match="only if all are grids over one parameter"):
        rs.plot([thresholds, thresholds], str(tmp_path / "f.png"))


def test_a_force_is_told_as_a_force():
    variables = {v.name for v in job("thresholds", arm=TALL).layout.variables}
    assert {"pressure_hopf", "pressure_end", "frequency_restabilization_hz"} <= variables
    arm = TALL | {"force": "0.1 N"}
    names = {v.name for v in job("branch", arm=TALL, stop=40).layout.variables}
    assert "branch_pressure" in names
    assert not any("pressure" in v.name for v in job("spectrum", arm=arm).layout.variables)


def test_a_load_along_F_is_selected_by_itself():
    data = rs.sweep("spectrum", arm=GLYCEROL | {"length": "10 cm", "pressure": ["1 kPa", "2 kPa"]}, modes=1)
    assert "pressure" in data.xindexes  # without an index only some versions of xarray select
    chosen = data.growth_rate.sel(pressure=1900, method="nearest")
    assert chosen.values.ravel() == data.growth_rate.sel(F=data.F[1]).values.ravel()


def test_points_that_no_rod_covers_have_a_status_and_the_others_their_numbers(command):
    command.write("a.yaml", CONFIG)
    done = command("run", "a.yaml")
    assert done.returncode == 0, done.stdout + done.stderr
    assert not (command.directory / "a.h5.log").exists()  # no solver was asked for what cannot be
    data = rs.open(command.directory / "a.h5")
    short = data.status.sel(length=0.04)
    assert (short == NOT_SLENDER).all()
    crushed = data.status.sel(young=1e3, length=0.1) == CRUSHED
    assert (crushed == (data.pressure >= 1000 * (1 - 1e-12))).all()
    assert np.isnan(data.growth_rate.where(data.status >= NOT_SLENDER)).all()
    assert (data.status.sel(young=1e5, length=[0.1, 0.11]) == 0).all()
    told = command("show", "a.h5").stdout
    assert "shorter than 10 radii" in told
    assert "compresses the arm to zero length" in told


def test_a_bore_as_wide_as_the_arm_is_a_corner_of_the_map():
    arm = GLYCEROL | {"length": "10 cm", "radius": ["4 mm", "5 mm"], "inner_radius": ["2 mm", "4 mm"]}
    data = rs.sweep("thresholds", arm=arm, crossings=4)
    assert data.status.values.ravel().tolist() == [0, NO_WALL, 0, 0]
    assert np.isfinite(data.pressure_hopf.values.ravel()).tolist() == [True, False, True, True]


def test_spectra_followed_along_the_load_are_those_of_single_arms(command):
    command.write("a.yaml", CONFIG)
    command.solved("a.yaml")
    data = rs.open(command.directory / "a.h5").sel(length=0.11, young=1e5)
    assert (data.elements[1:] == 0).all()  # followed
    alone = rs.sweep(
        "spectrum", arm=GLYCEROL | {"length": "11 cm", "pressure": data.pressure.values.tolist()}, modes=2,
        follow=False,
    )  # fmt: skip
    for name in ("growth_rate", "frequency_hz"):
        assert data[name].values == pytest.approx(alone[name].values.reshape(12, 2), rel=1e-8, abs=1e-8)


@pytest.mark.long
def test_neighbours_follow_each_other_along_the_load(command):
    command.write("a.yaml", CHAINS)
    command.solved("a.yaml")
    data = rs.open(command.directory / "a.h5")
    assert (data.status.sel(length=0.04) == NOT_SLENDER).all()
    pressures = ["2.3 kPa", "2.4 kPa", "2.5 kPa"]
    alone = rs.sweep(
        "limit_cycle", arm=GLYCEROL | {"length": "10 cm", "pressure": pressures}, start="neighbour",
        accuracy=1e-3, harmonics=2,
    )  # fmt: skip
    assert data.period.sel(length=0.1).values == pytest.approx(alone.period.values.ravel(), rel=1e-12)


@pytest.mark.long
@pytest.mark.parametrize("config", few([CONFIG, CHAINS], 1))
def test_shards_a_stopped_run_ranks_and_python_give_the_same_file(command, config):
    command.write("a.yaml", config)
    command.solved("a.yaml", "whole.h5")
    for shard in (1, 2):
        assert command("run", "a.yaml", "-o", f"{shard}.h5", "--shard", f"{shard}/2").returncode == 0
    assert command("merge", "merged.h5", "1.h5", "2.h5").returncode == 0
    assert command("run", "a.yaml", "-o", "1.h5").returncode == 0  # continues what the first shard began
    assert command("run", "a.yaml", "-o", "ranks.h5", ranks=2).returncode == 0
    whole = content(command.directory / "whole.h5")
    for name in ("merged.h5", "1.h5", "ranks.h5"):
        assert same(whole, content(command.directory / name))
    assert "nothing to do" in command("run", "a.yaml", "-o", "whole.h5").stdout


@pytest.mark.long
@pytest.mark.parametrize(
    ("config", "old", "new", "told"),
    few(
        [
            (
                CONFIG,
                "[4 cm, 10 cm, 11 cm]",
                "[4 cm, 0.1 m, 105 mm, 11 cm]",
                "24 of 96 points to do, 72 kept",
            ),
            (CHAINS, "2.5 kPa]", "2.5 kPa, 2.6 kPa]", "3 of 12 points to do, 9 kept"),
            (
                CONFIG,
                "stop: 1.2 kPa, num: 12",
                "stop: 1.4 kPa, num: 14",
                "72 of 72 stored points are computed",
            ),
            (CHAINS, "11 cm]", "11 cm, 12 cm]", "3 of 12 points to do, 9 kept"),
        ],
        1,
    ),
)
def test_extension_gives_the_file_of_the_larger_grid(command, config, old, new, told):
    command.write("small.yaml", config)
    command.write("large.yaml", config.replace(old, new))
    command.solved("small.yaml", "c.h5")
    refused = command("run", "large.yaml", "-o", "c.h5")
    assert refused.returncode == 2
    assert "--extend computes only the missing points" in refused.stderr
    extended = command("run", "large.yaml", "-o", "c.h5", "--extend")
    assert extended.returncode == 0, extended.stderr
    assert told in extended.stdout
    assert command("run", "large.yaml").returncode == 0
    assert same(content(command.directory / "large.h5"), content(command.directory / "c.h5"))


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("[4 cm, 10 cm, 11 cm]", "[4 cm, 12 cm]", "length = 0.1 is in the file and not in the config"),
        (
            "radius: 5 mm",
            "radius: 4 mm",
            "parameters.arm.radius is 0.005 in the file and 0.004 in the config",
        ),
        ("spectrum: {", "  gamma3: 0.001\nspectrum: {", "parameters.gamma3 is not given in the file"),
        (
            "radius: 5 mm",
            "radius: [5 mm, 6 mm]",
            "radius is 0.005 in the file and variable in the config",
        ),
    ],
)
def test_what_is_no_extension_is_refused_in_a_sentence(command, old, new, sentence):
    command.write("small.yaml", CONFIG)
    command.write("large.yaml", CONFIG.replace(old, new))
    command.solved("small.yaml", "c.h5")
    refused = command("run", "large.yaml", "-o", "c.h5", "--extend")
    assert refused.returncode == 2
    assert sentence in refused.stderr
    assert refused.stderr.count("\n") == 1


def test_axes_are_sealed(command):
    command.write("a.yaml", CONFIG)
    command.solved("a.yaml")
    path = command.directory / "a.h5"
    data = rs.open(path)
    data.to_netcdf(command.directory / "copy.h5", engine="h5netcdf")
    xr.testing.assert_identical(rs.open(command.directory / "copy.h5"), data)
    with h5py.File(path, "r+") as file:
        file["length"][1] = 0.105
    with pytest.raises(rs.InputError, match="variable length was changed after rodsweep wrote it"):
        rs.open(path)


def test_python_gives_what_the_file_has(command):
    command.write("a.yaml", CONFIG)
    command.solved("a.yaml")
    file = rs.open(command.directory / "a.h5")
    arm = {
        "length": ["4 cm", "10 cm", "11 cm"],
        "radius": "5 mm",
        "young": ["1 kPa", "100 kPa"],
        "viscosity": "1.4 Pa s",
        "pressure": rs.linspace("0.1 kPa", "1.2 kPa", 12),
    }
    here = rs.sweep("spectrum", arm=arm, modes=2)
    assert set(file.coords) == set(here.coords)
    for name in file.variables:
        if name != "seconds":
            xr.testing.assert_identical(file[name], here[name])


def test_viscosity_is_an_axis_of_times_alone():
    arm = GLYCEROL | {"length": "10 cm", "viscosity": ["1.4 mPa s", "1.4 Pa s"]}
    data = rs.sweep("thresholds", arm=arm, crossings=4)
    assert data.F_hopf[0] == data.F_hopf[1]
    ratio = data.frequency_hopf_hz[0] / data.frequency_hopf_hz[1]
    assert ratio.item() == pytest.approx(1000, rel=1e-12)
    other = arm | {"viscosity": ["1.4 mPa s", "2 Pa s"]}
    one, two = (job("thresholds", arm=each, crossings=4) for each in (arm, other))
    assert not np.array_equal(one.points.identifying_arrays[0], two.points.identifying_arrays[0])


def test_a_parameter_beside_the_arm_is_an_axis_too():
    arm = GLYCEROL | {"length": ["10 cm", "12 cm"], "pressure": "2 kPa"}
    data = rs.sweep("spectrum", arm=arm, gamma3=[0.001, 0.01], modes=1)
    assert data.growth_rate.dims == ("length", "gamma3", "mode")
    assert data.F.dims == ("length", "gamma3")
    single = SlenderArm(**GLYCEROL | {"length": "12 cm", "pressure": "2 kPa"})
    rod = rs.Rod(F=single.F, k1=single.k1, k2=single.k2, gamma3=0.01)
    found = data.growth_rate.sel(length=0.12, gamma3=0.01).item()
    assert found == pytest.approx(rod.spectrum(modes=1).growth_rate[0], rel=1e-8)


def test_a_list_of_a_grid_has_every_point_in_its_order(command):
    command.write("a.yaml", CONFIG)
    command.solved("a.yaml")
    view = read_view(command.directory / "a.h5")
    listed = view.as_list
    assert not view.is_grid
    assert listed.variables["growth_rate"].shape == (72, 2)
    places = np.unravel_index(np.arange(72), (3, 2, 12))
    for name, place in zip(view.arm_axes, places, strict=True):
        assert (listed.variables[name] == view.variables[name][place]).all()
    assert listed.point_columns["F"] == pytest.approx(view.variables["F"].ravel(), nan_ok=True)


def test_map_of_configs_has_the_numbers_that_it_states(command):
    done = command("run", ROOT / "configs" / "arm_map.yaml", "-o", "map.h5")
    assert done.returncode == 0, done.stdout + done.stderr
    data = rs.open(command.directory / "map.h5")
    assert (data.status == NOT_SLENDER).sum("young").values.tolist() == [4] + [0] * 8
    there = data.sel(length=0.1, young=1e5, method="nearest")
    assert there.F_hopf.item() == pytest.approx(34.809000317504, rel=1e-9)
    assert there.pressure_hopf.item() == pytest.approx(2175.56, abs=0.005)
    assert there.frequency_hopf_hz.item() == pytest.approx(0.27439, abs=5e-6)
    ratio = data.pressure_hopf / data.young
    assert np.ptp(ratio.values[1:], axis=1) == pytest.approx(0, abs=1e-12)
    rods = data.model_applies.where(data.status == 0)
    assert np.argwhere((rods == Validity.does_not_apply).values).tolist() == [[1, 3]]


def test_a_length_between_the_ends_of_a_range_is_found_as_it_is_typed():
    data = rs.sweep("thresholds", arm=GLYCEROL | {"length": {"start": "4 cm", "stop": "12 cm", "num": 9}})
    assert data.length.values.tolist() == [0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1, 0.11, 0.12]
    assert data.F_hopf.sel(length=0.1) > 0


def test_a_table_has_nothing_where_an_arm_has_no_rod(command):
    command.write("a.yaml", CONFIG)
    command.solved("a.yaml")
    columns = ("--table", "points", "--columns", "length,k1,status,unstable_count")
    assert command("export", "a.h5", *columns).returncode == 0
    rows = [line.split(",") for line in (command.directory / "a.csv").read_text().splitlines()[1:]]
    assert {tuple(row[1:]) for row in rows if row[2] == "not_slender"} == {("", "not_slender", "")}
    assert all(float(row[1]) > 0 for row in rows if row[2] == "ok")
