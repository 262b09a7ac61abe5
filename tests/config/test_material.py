"""The section material, the parameter taper, and profiles in files: what is taken, and each refusal."""

import re

import h5py
import numpy as np
import pytest

import rodsweep as rs
from rodsweep.config import read_config
from rodsweep.errors import InputError
from rodsweep.model.material.profile import Profile
from rodsweep.tasks.running.job import job_of_file
from rodsweep.wording import counted

BASE = """
task: {task}
parameters: {{F: [1, 2], k1: 1e4, k2: 1e4, gamma3: 1e-4{more}}}
{rest}
"""
STEPPED = "u,k3,gamma3\n0,1,1\n0.4,1,1\n0.4,0.2,0.5\n1,0.2,0.5\n"


def config(directory, rest="", more="", task="spectrum"):
    path = directory / "arm.yaml"
    path.write_text(BASE.format(task=task, more=more, rest=rest))
    return read_config(path)[0]


def test_profile_of_a_file_is_part_of_the_config(tmp_path):
    (tmp_path / "steps.csv").write_text(STEPPED)
    read = config(tmp_path, "material: {profile: steps.csv}")
    table = "material: {profile: {u: [0, 0.4, 0.4, 1], k3: [1, 1, 0.2, 0.2], gamma3: [1, 1, 0.5, 0.5]}}"
    assert read.rod_material == config(tmp_path, table).rod_material
    assert read.settings_of_results == config(tmp_path, table).settings_of_results
    assert read.rod_material.profile.rows[2] == (1.0, 1.0, 0.2, 1.0, 1.0, 0.5)
    assert not read.is_uniform_and_linear


def test_default_material_means_the_same_as_none(tmp_path):
    plain, written = config(tmp_path), config(tmp_path, "material: {law: linear}")
    assert written.is_uniform_and_linear
    assert plain.settings_of_results == written.settings_of_results


def test_rows_at_the_smallest_distance_are_taken_whatever_the_rounding():
    """0.400001 - 0.4 is below 1e-6 in floating-point numbers."""
    assert 0.400001 - 0.4 < 1e-6
    for start, end in ((0.1, 0.100001), (0.4, 0.400001), (0.8, 0.800001)):
        assert Profile((0.0, start, end, 1.0), ((1.0,) * 6,) * 4).breaks.tolist() == [0.0, start, end, 1.0]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("u,k3\n0.1,1\n1,1\n", "the rows go from u = 0.1 to 1; they must go from 0 to 1"),
        ("u,k3\n0,1\n0.5,0\n1,1\n", "the factor of k3 at u = 0.5 is 0; it must be finite and above 0"),
        ("u,k3\n0,1\n0.5,1\n0.5,1\n0.5,2\n1,1\n", "there are 3 rows at u = 0.5; allowed: two rows"),
        ("u,k3\n0,1\n0.6,1\n0.5,1\n1,1\n", "u = 0.5 follows u = 0.6; u must not decrease"),
        (
            "u,k3\n0,1\n0.5,1\n0.5000001,2\n1,2\n",
            "two rows near u = 0.5 differ by 1e-07 in u; allowed: 0 (a jump) or at least 1e-06",
        ),
        ("u,k3\n0,1\n1\n", "row 2 has 1 value, but the header names 2"),
        ("u,k3\n0,1\n1,one\n", "row 2: k3 = 'one' is not a number"),
        (
            "u,k9\n0,1\n1,1\n",
            "the header must name u and any of k1, k2, k3, gamma1, gamma2, gamma3, each once",
        ),
        ("k3\n1\n", "the header must name u"),
        ("u,k3,k3\n0,1,1\n1,1,1\n", "each once"),
        ("", "the header must name u"),
    ],
)
def test_profiles_that_are_none_are_refused_in_a_sentence(tmp_path, text, sentence):
    (tmp_path / "bad.csv").write_text(text)
    with pytest.raises(InputError, match=re.escape(sentence)) as refusal:
        config(tmp_path, "material: {profile: bad.csv}")
    assert "material.profile" in str(refusal.value)


@pytest.mark.parametrize(
    ("rest", "more", "sentence"),
    [
        (
            "material: {law: rubber}",
            "",
            "material.law = 'rubber' is not allowed; it should be linear or neo_",
        ),
        ("material: {section: swelling}", "", "material: section = swelling is not known for law = linear"),
        ("material: {profile: no.csv}", "", "no.csv does not exist"),
        ("material: {laws: linear}", "", "unknown key material.laws; did you mean law?"),
        ("material: {mu: 2}", "", "unknown key material.mu"),
        ("material: {profile: {u: [0, 1], k3: []}}", "", "material.profile: k3 has 0 values and u has 2"),
        ("material: {profile: {u: [0, 1], k3: 2}}", "", "k3 = 2 is not allowed; it should be a list of"),
        ("material: {}", "", "material: no key is given; give law, section or profile"),
        ("material: {profile: {u: [0, 1], k3: [1]}}", "", "material.profile: k3 has 1 value and u has 2"),
    ],
)
def test_bad_materials_are_refused_in_a_sentence(tmp_path, rest, more, sentence):
    with pytest.raises(InputError, match=re.escape(sentence)):
        config(tmp_path, rest, more)


@pytest.mark.parametrize("taper", [0, -1, 0.001, 1000])
def test_a_taper_of_a_point_is_refused(taper):
    with pytest.raises(InputError, match=r"parameters.taper = .* it must be a number from 0.01 to 100"):
        rs.Rod(F=1, k1=1e4, k2=1e4, gamma3=1e-4, taper=taper).spectrum()


def test_the_tip_of_a_cone_is_crushed_first():
    rod = {"k1": 40.0, "k2": 1e4, "gamma3": 1e-4, "taper": 0.5}
    assert rs.Rod(F=9.9, **rod).spectrum().certified
    with pytest.raises(InputError, match="the weakest section of the arms is crushed at 10"):
        rs.Rod(F=10, **rod)
    assert rs.Rod(F=100, law="neo_hookean", **rod).spectrum().certified


@pytest.mark.parametrize("section", ["fixed", "swelling"])
@pytest.mark.parametrize(("F", "taper", "limit"), [(1.001e7, 1, "10000000"), (1e100, 0.5, "2500000")])
def test_rubber_compressed_beyond_its_digits_is_refused(section, F, taper, limit):
    rod = {"k1": 1e4, "k2": 1e3, "gamma3": 1e-3, "taper": taper, "law": "neo_hookean", "section": section}
    with pytest.raises(InputError, match=f"is above {limit}, 1000 times the stretch stiffness"):
        rs.Rod(F=F, **rod)
    assert rs.Rod(F=0.9 * float(limit), **rod).parameters["F"] == 0.9 * float(limit)


@pytest.mark.parametrize(("F", "taper", "limit"), [(-1.001e54, 1, "-1e+54"), (-1e300, 0.5, "-2.5e+53")])
def test_swelling_rubber_stretched_until_its_law_overflows_is_refused(F, taper, limit):
    rod = {"k1": 1e4, "k2": 1e3, "gamma3": 1e-3, "taper": taper, "law": "neo_hookean"}
    with pytest.raises(InputError, match=f"is below {re.escape(limit)}; the stretch of swelling rubber"):
        rs.sweep("spectrum", F=[F, 1], section="swelling", **rod)
    assert np.isfinite(rs.Rod(F=0.9 * float(limit), section="swelling", **rod).parameters["F"])
    assert rs.Rod(F=F, **rod).parameters["F"] == F


@pytest.mark.parametrize("task", ["spectrum", "modes"])
def test_check_states_a_finite_time_of_pulls_whose_waves_overflow(command, task):
    text = BASE.format(task=task, more=", taper: 0.5", rest="").replace("[1, 2]", "[-1.0e+202, 2]")
    checked = command("check", command.write("a.yaml", text))
    assert checked.stderr == ""
    seconds = re.search(r"expected cost: (\S+) s on one rank", checked.stdout)
    assert np.isfinite(float(seconds[1]))


def test_searches_that_compress_rubber_beyond_its_digits_are_refused():
    rod = rs.Rod(k1=0.01, k2=1e3, gamma3=1e-3, law="neo_hookean")
    with pytest.raises(InputError, match="thresholds: F = 11 is above 10, 1000 times the stretch stiffness"):
        rod.thresholds(F_max=11)
    with pytest.raises(InputError, match=r"criticality: F = 1e\+100 is above 10"):
        rod.criticality(F_max=1e100)
    with pytest.raises(InputError, match="branch: F = 5 is above 1, 1000 times"):
        rod.replace(F=5).branch(along="k1", start=0.001, stop=200)


def test_a_list_of_points_with_rubber_compressed_beyond_its_digits_is_refused(tmp_path):
    (tmp_path / "rods.csv").write_text("F,k1,k2,gamma3\n1,9,9,0.1\n9001,9,9,0.1\n")
    with pytest.raises(InputError, match="line 3: F = 9001 is above 9000, 1000 times the stretch stiffness"):
        rs.sweep("spectrum", points=tmp_path / "rods.csv", law="neo_hookean")


def test_a_run_stores_what_was_asked_and_continues_only_that(command):
    (command.directory / "steps.csv").write_text(STEPPED)
    text = BASE.format(task="spectrum", more=", taper: [0.7, 1]", rest="material: {profile: steps.csv}")
    (command.directory / "arm.yaml").write_text(text)
    assert command("run", "arm.yaml").returncode == 0
    with h5py.File(command.directory / "arm.h5") as file:
        assert file["growth_rate"].shape == (2, 1, 1, 1, 2, 4)
        assert file["taper"][...].tolist() == [0.7, 1.0]
        assert file["taper"].attrs["units"] == "1"
        assert np.unique(file["certified"][...]).tolist() == [1]
    assert "nothing to do" in command("run", "arm.yaml").stdout
    shown = command("show", "arm.h5").stdout
    assert "taper 2 0.7 1 1" in " ".join(shown.split())
    (command.directory / "steps.csv").write_text(STEPPED.replace("0.5", "0.6"))
    other = command("run", "arm.yaml")
    assert other.returncode == 2
    assert "material.profile.gamma3" in other.stderr
    checked = " ".join(command("check", "arm.yaml").stdout.split())
    assert "cones of radius ratios 0.7 to 1 with a profile of 4 rows with 1 jump" in checked


def test_rod_of_python_repeats_its_material():
    rod = rs.Rod(F=3, k1=500, k2=1e4, gamma3=1e-4, taper=0.5, law="neo_hookean", section="swelling")
    assert repr(rod).endswith("taper=0.5, law='neo_hookean', section='swelling')")
    assert rod == rod.replace(F=3)
    assert rod != rod.replace(section="fixed")
    assert rod != rs.Rod(F=3, k1=500, k2=1e4, gamma3=1e-4, taper=0.5)
    assert hash(rod) == hash(rod.replace())


@pytest.mark.long
def test_show_and_files_say_what_rests_on_an_estimate(command):
    """The winding number of a cone rests on estimated bounds; that of uniform rods of any law does not."""
    said = {}
    for name, taper, law in (
        ("cone", "0.5", "linear"),
        ("rubber", "1", "neo_hookean"),
        ("plain", "1", "linear"),
    ):
        for task, F in (("spectrum", "F: [10, 20], "), ("thresholds", "")):
            axes = f"{F}k1: 1.0e4, k2: 1.0e4, gamma3: 1.0e-4, taper: {taper}"
            text = f"task: {task}\nparameters: {{{axes}}}\nmaterial: {{law: {law}}}\n"
            command.write(f"{name}.yaml", text)
            assert command("run", f"{name}.yaml", "--fresh").returncode == 0
            with h5py.File(command.directory / f"{name}.h5") as file:
                meaning = file["certified"].attrs["long_name"]
            said[name, task] = command("show", f"{name}.h5").stdout + meaning
    assert (
        "largest number of unstable modes: 2; the number is confirmed by an estimate at 2 of 2 points"
        in said["cone", "spectrum"]
    )
    assert "known only to lie between two forces of the file" in said["cone", "spectrum"]
    assert "the proof is partly an estimate" in said["cone", "spectrum"]
    for name in ("rubber", "plain"):
        assert "proved at 2 of 2 points" in said[name, "spectrum"]
        assert "estimated" not in said[name, "spectrum"]
    for name in ("cone", "rubber"):
        assert "the list of crossings is confirmed by counts of unstable modes" in said[name, "thresholds"]
        assert "proved" not in said[name, "thresholds"]
    assert "the list of crossings is proved complete" in said["plain", "thresholds"]


def test_compression_is_judged_where_the_arm_is_weakest_and_not_for_rubber():
    arm = {
        "length": "12 cm",
        "radius": "6 mm",
        "young": "100 kPa",
        "viscosity": "4 kPa s",
        "pressure": "2 kPa",
    }
    found = {}
    for taper, law in ((1.0, "linear"), (0.5, "linear"), (0.5, "neo_hookean")):
        data = rs.sweep("spectrum", arm=arm, taper=taper, law=law)
        words = data.neglected_effect.attrs["flag_meanings"].split()
        found[taper, law] = words[1 + data.neglected_effect.item()], data.neglected_excess.item()
    share = 2e3 * np.pi * 0.006**2 / (1e5 * np.pi * 0.006**2)
    assert found[1.0, "linear"] == ("compression", pytest.approx(share / 0.1))
    assert found[0.5, "linear"] == ("compression", pytest.approx(4 * share / 0.1))
    assert found[0.5, "neo_hookean"][0] != "compression"


@pytest.mark.long
def test_cycles_of_cones_are_stored_with_their_hopf_points(command):
    rest = "material: {profile: steps.csv}\nlimit_cycle: {start: neighbour}\naccuracy: 1.0e-5"
    (command.directory / "steps.csv").write_text(STEPPED)
    parameters = "{F: [40, 44, 48], k1: 1.0e4, k2: 100, gamma3: 0.01, gamma1: 1, taper: [0.8, 1]}"
    command.write("whole.yaml", f"task: limit_cycle\nparameters: {parameters}\n{rest}\n")
    assert command("run", "whole.yaml").returncode == 0
    with h5py.File(command.directory / "whole.h5") as whole:
        assert whole["period"].shape == (3, 1, 1, 1, 1, 2)
        assert set(whole["hopf_taper"][...].tolist()) > {0.8, 1.0}  # and one found along the taper
        for F, taper in zip(whole["hopf_F"][...], whole["hopf_taper"][...], strict=True):
            path = str(command.directory / "steps.csv")
            rod = rs.Rod(F=F, k1=1e4, k2=100, gamma3=0.01, taper=taper, profile=path)
            spectrum = rod.spectrum(modes=6)
            assert (abs(spectrum.growth_rate) < 1e-7 * spectrum.frequency).any()
    shown = command("show", "whole.h5").stdout
    assert "is confirmed by counts of unstable modes for" in shown


def test_branches_are_followed_in_the_taper():
    branch = rs.Rod(F=30, k1=500, k2=1e4, gamma3=1e-3).branch(
        along="taper", start=0.4, stop=1.5, accuracy=1e-6
    )
    assert branch.status == "ok"
    hopf = branch.special_points.special_at.iloc[0]
    edge = rs.Rod(F=30, k1=500, k2=1e4, gamma3=1e-3, taper=hopf).spectrum(modes=1)
    assert abs(edge.growth_rate.item()) < 1e-9 * edge.frequency.item()
    points = branch.cycles
    middle = points.iloc[len(points) // 2]
    alone = rs.Rod(F=30, k1=500, k2=1e4, gamma3=1e-3, taper=middle.branch_taper).cycle(accuracy=1e-8)
    assert middle.period == pytest.approx(alone.period, rel=1e-6)
    assert middle.tip_y_max == pytest.approx(alone.tip_y_max, rel=1e-6)


ALONE = "parameters: {F: 9, k1: 1e4, k2: 1e4, gamma3: 1e-4}"
CONE = ALONE.replace("}", ", taper: 0.5}")
RUBBER = "material: {law: neo_hookean, section: swelling}"
JUMP = "material: {profile: {u: [0, 0.4, 0.4, 1], k3: [1, 1, 0.2, 0.2]}}"
SAID = [
    (CONE, RUBBER, "a cone of radius ratio 0.5 of neo-Hookean rubber with a swelling section"),
    (ALONE, RUBBER, "a uniform arm of neo-Hookean rubber with a swelling section"),
    (ALONE, JUMP.replace("0.4, 0.4", "0.4, 0.5"), "an arm with a profile of 4 rows of linear material"),
    (ALONE, JUMP, "an arm with a profile of 4 rows with 1 jump of linear material"),
]


@pytest.mark.parametrize(("parameters", "material", "arm"), SAID)
def test_check_states_the_arm_and_the_mesh_on_which_it_is_solved(tmp_path, parameters, material, arm):
    """These arms need no finer mesh than the first."""
    (tmp_path / "a.yaml").write_text(f"task: spectrum\n{parameters}\n{material}")
    made = job_of_file(tmp_path / "a.yaml", ())
    solved = made.solver().solve(0)
    mesh = f"{counted(solved.elements, 'element')} of order {solved.order}"
    assert made.task.arms_line() == f"{arm}; the first mesh has {mesh}"


def test_check_states_the_largest_mesh_of_a_grid(tmp_path):
    """The thinnest tip under the largest force needs more than any other arm."""
    cones = BASE.format(task="spectrum", more=", taper: [0.1, 1.1]", rest="")
    hardest = cones.replace("[1, 2]", "2").replace("[0.1, 1.1]", "0.1")
    said = []
    for text in (cones, hardest):
        (tmp_path / "a.yaml").write_text(text)
        said.append(job_of_file(tmp_path / "a.yaml", ()).task.arms_line())
    assert said[0].startswith("cones of radius ratios 0.1 to 1.1 of linear material; ")
    assert said[0].split("; ")[1].replace(" of the hardest arm", "") == said[1].split("; ")[1]


def test_check_states_no_mesh_of_uniform_arms_of_linear_material(tmp_path):
    (tmp_path / "a.yaml").write_text(BASE.format(task="spectrum", more="", rest=""))
    assert job_of_file(tmp_path / "a.yaml", ()).task.arms_line() == ""


@pytest.mark.parametrize("start", ["mode", "hopf"])
def test_check_states_the_first_mesh_of_cycles(tmp_path, start):
    text = f"task: limit_cycle\n{CONE}\nlimit_cycle: {{start: {start}}}"
    (tmp_path / "a.yaml").write_text(text)
    assert re.fullmatch(
        r"a cone of radius ratio 0.5 of linear material; the first mesh has 1 element of order \d+",
        job_of_file(tmp_path / "a.yaml", ()).task.arms_line(),
    )


@pytest.mark.parametrize("task", ["spectrum", "modes", "limit_cycle", "thresholds", "criticality", "branch"])
def test_check_states_the_mesh_of_a_list_of_arms(tmp_path, task):
    forces = task in {"spectrum", "modes", "limit_cycle"}
    rows = ["F,k1,k2,gamma3,taper,gamma1", "15,1e4,1e3,1e-3,0.6,1", "15,1e3,1e2,1e-2,1,1"]
    rows = rows if forces else [row.split(",", 1)[1] for row in rows]
    rows = (
        rows if task in {"limit_cycle", "criticality", "branch"} else [row[: row.rindex(",")] for row in rows]
    )
    (tmp_path / "list.csv").write_text("\n".join(rows) + "\n")
    (tmp_path / "a.yaml").write_text(f"task: {task}\nparameters: {{points: list.csv}}\n")
    said = job_of_file(tmp_path / "a.yaml", ()).task.arms_line()
    assert said.startswith("cones of radius ratios 0.6 to 1 of linear material; the first mesh ")


def test_check_foresees_minutes_where_many_modes_of_an_arm_grow(tmp_path):
    """24 points with up to 160 growing modes took 95 s; cones with few growing modes take milliseconds."""
    arms = "F: {{start: 0, stop: {stop}, num: 24}}, k1: 1.0e5, k2: {k2}, gamma3: 1.0e-3, taper: {taper}"
    seconds = []
    for numbers in ({"stop": 40, "k2": 5, "taper": 0.1}, {"stop": 20, "k2": 1000, "taper": 0.6}):
        (tmp_path / "a.yaml").write_text(f"task: spectrum\nparameters: {{{arms.format(**numbers)}}}\n")
        seconds.append(job_of_file(tmp_path / "a.yaml", ()).task.cost().seconds)
    assert 95 / 3 < seconds[0] < 95 * 3
    assert seconds[1] < 1
