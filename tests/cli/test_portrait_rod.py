"""The rod that the options of `rodsweep portrait` describe, and the progress of its solves."""

import time
from types import SimpleNamespace

import pytest

import rodsweep as rs
from rodsweep.cli.portrait_rod import rod_of_options, solve_with_progress
from rodsweep.errors import InputError
from rodsweep.post.rod_portrait.results import DescribedRod
from rodsweep.solve_progress import SolvePosition, report
from rodsweep.tasks.rod_portrait import PortraitRequest

NO_MATERIAL = dict.fromkeys(("law", "section", "profile"))
ROD = {"k1": 1e4, "k2": 100.0, "gamma3": 0.01}
ARM = {"length": "10 cm", "radius": "5 mm", "tip_radius": "4 mm", "young": "100 kPa", "viscosity": "12 Pa s"}


def test_an_arm_is_the_arm_that_it_is_in_python(monkeypatch):
    arm = rs.Arm(**ARM, law="neo_hookean", section="swelling")
    swelling = {"law": "neo_hookean", "section": "swelling", "profile": None}
    found = rod_of_options({}, ARM, swelling)
    assert found == DescribedRod(arm={**ARM, "law": "neo_hookean", "section": "swelling"})
    described = []
    monkeypatch.setattr(
        "rodsweep.api.answers.rod_portrait.solve_portrait", lambda *words: described.append(words[1])
    )
    arm.portrait()
    assert points_of(described[0].rod) == points_of(found)
    assert points_of(rod_of_options({"gamma3": 0.5}, ARM, NO_MATERIAL))["gamma3"] == 0.5


def points_of(rod: DescribedRod) -> dict[str, float]:
    """Parameters that a task has of a rod at F = 40."""
    points = PortraitRequest(rod=rod).job_of_task("limit_cycle", {}, 40.0).points
    return {name: float(values[0]) for name, values in points.columns_by_name.items()}


def test_an_arm_in_segments_has_the_profile_of_its_config():
    segments = ["5 cm: radius 6 mm, young 80 kPa", "5 cm: radius 4 mm, young 100 kPa"]
    found = rod_of_options({}, {"segments": segments, "viscosity": "12 Pa s"}, NO_MATERIAL)
    material = PortraitRequest(rod=found).job_of_task("thresholds", {}).config.rod_material
    assert material == rs.Arm(segments=segments, viscosity="12 Pa s").material
    assert found.description == f"segments {segments[0]} | {segments[1]}, viscosity 12 Pa s"


def test_a_rod_has_its_law_and_the_profile_of_a_file(tmp_path):
    (tmp_path / "p.csv").write_text("u,k3\n0,1\n1,0.5\n")
    material = {"law": "neo_hookean", "section": None, "profile": str(tmp_path / "p.csv")}
    found = rod_of_options({**ROD, "taper": 0.9}, {}, material)
    assert found.parameters == {**ROD, "gamma1": 1.0, "taper": 0.9}
    assert found.material == {"law": "neo_hookean", "profile": {"u": [0, 1], "k3": [1, 0.5]}}
    assert found.description.endswith("taper = 0.9, law neo_hookean, a profile along its length")


@pytest.mark.parametrize(
    ("parameters", "quantities", "sentence"),
    [
        ({"k1": 10.0}, {}, "--k2 is missing; give --k1, --k2, --gamma3, or the quantities of an arm"),
        ({}, {**ARM, "viscosity": "-1 Pa s"}, "--viscosity = '-1 Pa s' is not above 0"),
    ],
)
def test_options_that_are_no_rod_are_refused(parameters, quantities, sentence):
    with pytest.raises(InputError) as refusal:
        rod_of_options(parameters, quantities, NO_MATERIAL)
    assert str(refusal.value).startswith(sentence)


def test_progress_counts_the_solves_and_says_where_a_long_one_is():
    class Recorder:
        def __init__(self):
            self.counts, self.places, self.is_open = [], [], True

        def __call__(self, done):
            self.counts.append(done)

        def show_position(self, words, begun):
            self.places.append((words, begun))

        def close(self):
            self.is_open = False

    def solve(job):
        while not shown.places:
            report(lambda: SolvePosition("F = 30", 0.5))
            time.sleep(0.01)
        return job

    shown = Recorder()
    job = SimpleNamespace(config=SimpleNamespace(task="limit_cycle"))
    with pytest.raises(KeyboardInterrupt), solve_with_progress(shown, solve) as shown_solve:
        assert shown_solve(job) is job
        assert (shown.counts, shown.places) == ([0, 1], [("limit cycle: F = 30", 0.5)])
        raise KeyboardInterrupt
    assert not shown.is_open
