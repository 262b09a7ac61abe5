"""Estimated costs are finite for every allowed force, and close to the times of soft and pulled rods."""

import math
import re

import numpy as np
import pytest

from rodsweep.api.keyword_arguments import config_tree, job_of_tree
from rodsweep.cli.checking import print_job_check
from rodsweep.tasks.running.job import job_of_file


@pytest.mark.parametrize("F_max", [200.0, 1e150, 1e300])
def test_cost_of_thresholds_is_finite_without_a_warning(F_max):
    keywords = {"k1": np.inf, "k2": 1e4, "gamma3": 1e-4, "F_max": F_max}
    cost = job_of_tree(config_tree("thresholds", keywords)).task.cost()
    assert 0 < cost.seconds < math.inf


@pytest.mark.parametrize(
    ("task", "keywords", "measured"),
    [
        # Seconds on one core.
        ("spectrum", {"F": -1e4, "k2": 1e4}, 0.016),
        ("spectrum", {"F": -1e4, "k2": 1e2, "gamma3": 1e-2}, 2.8),
        ("spectrum", {"F": -1e6, "k2": 1e4}, 0.24),
        ("spectrum", {"F": 20.0, "k2": 1e-3}, 0.89),
        ("spectrum", {"F": 100.0, "k2": 1e-2}, 2.8),
        ("spectrum", {"F": 100.0, "k2": 1e-3}, 100.0),
        ("spectrum", {"F": 2000.0, "k2": 1e4}, 0.009),
        ("spectrum", {"F": -5e3, "k2": 1e4, "taper": 0.5}, 0.31),
        ("spectrum", {"F": [-1e4, -1e3, 100], "k2": 1e2, "method": "krylov_schur"}, 0.16),
        ("thresholds", {"k2": [0.01, 0.1], "F_max": 45}, 3.4),
        ("thresholds", {"k2": [1, 100], "taper": 0.5, "F_max": 45}, 21.5),
        ("criticality", {"k2": [0.1, 1], "F_max": 45}, 0.65),
        ("phase_diagram", {"F": [0, 20, 40], "k1": [1e3, 1e4], "k2": 0.1}, 0.85),
        ("phase_diagram", {"F": [-1e4, 0, 100], "k1": [3e4, 1e5], "k2": 1e4}, 0.88),
        ("phase_diagram", {"F": [-1e6, 0, 100], "k1": [3e6, 1e7], "k2": 1e4}, 0.06),
        ("phase_diagram", {"F": [-1e5, 0, 100], "k1": [3e6, 1e7], "k2": 1e6}, 0.45),
        ("phase_diagram", {"F": [-1e3, 0, 100], "k1": [2e3, 1e4], "k2": 1e4, "taper": 0.5}, 4.2),
        ("phase_diagram", {"F": [-500, 0, 100], "k1": [2e3, 1e4], "k2": 100}, 0.5),
        ("modes", {"F": [10, 60], "k1": [1e2, 1e3, 1e4], "k2": [30, 1e4], "modes": 12}, 0.65),
        ("modes", {"F": [10, 60], "k1": [1e2, 1e3, 1e4], "k2": [30, 1e4], "modes": 2, "growth": True}, 0.75),
        ("modes", {"F": -1e3, "k1": 200, "k2": 1e4}, 0.075),
        ("modes", {"F": -3e3, "k1": 200, "k2": [1e4, 1e5]}, 1.3),
        ("modes", {"F": -1e4, "k1": 200, "k2": 1e5}, 11.0),
        ("modes", {"F": -500, "k1": 200, "k2": 1e4, "taper": 0.6}, 0.24),
        ("limit_cycle", {"F": -1e4, "k2": 1e4}, 6.5),
        ("limit_cycle", {"F": -100, "k2": 1e4}, 0.1),
        ("limit_cycle", {"F": [30, 40, 60], "k2": 100, "gamma3": 1e-2, "method": "integration"}, 5.2),
    ],
)
def test_costs_of_soft_and_pulled_rods_have_the_size_of_the_measured_times(task, keywords, measured):
    """Within a factor of four; some were estimated at a thousandth or a hundred thousand times the time."""
    given = {"k1": 1e4, "gamma3": 1e-4} | keywords
    cost = job_of_tree(config_tree(task, given)).task.cost()
    assert measured / 4 < cost.seconds < 4 * measured


@pytest.mark.parametrize(("k2", "doubtful"), [(1e4, True), (1e6, False)])
def test_the_cost_of_rows_pulled_beyond_the_shear_stiffness_is_said_to_be_uncertain(k2, doubtful):
    keywords = {"F": [-2e4, 0.0, 100.0], "k1": [3e5, 1e6], "k2": k2, "gamma3": 1e-4}
    doubt = job_of_tree(config_tree("phase_diagram", keywords)).task.cost().underestimated_rods
    assert doubt == ("rows that begin at a pull beyond the shear stiffness" if doubtful else "")


@pytest.mark.parametrize(("task", "taper"), [("spectrum", 1.0), ("spectrum", 0.8), ("modes", 1.0)])
@pytest.mark.parametrize(("F", "doubtful"), [(-100, True), (-10, False), (10, False)])
def test_the_cost_of_spectra_beyond_the_shear_stiffness_is_said_to_be_uncertain(task, taper, F, doubtful):
    """A rod with gamma3 = 2e-5 took 800 times as long as estimated."""
    keywords = {"F": F, "k1": 400, "k2": 20, "gamma3": 2e-5} | ({"taper": taper} if taper < 1 else {})
    doubt = job_of_tree(config_tree(task, keywords)).task.cost().underestimated_rods
    assert doubt == ("rods under a pull beyond the shear stiffness" if doubtful else "")


@pytest.mark.parametrize(("taper", "seconds"), [(0.5, (0.15, 1.0)), (1.0, (0.0, 0.02))])
def test_check_adds_the_time_to_load_what_solves_arms(taper, seconds, tmp_path, capsys):
    """30 spectra of cones took 0.25 to 1.1 s on their first group, and were estimated at 0.014 s."""
    parameters = f"F: {{start: 0, stop: 30, num: 30}}, k1: 1.0e4, k2: 1.0e4, gamma3: 1.0e-4, taper: {taper}"
    (tmp_path / "a.yaml").write_text(f"task: spectrum\nparameters: {{{parameters}}}\n")
    print_job_check(job_of_file(tmp_path / "a.yaml", ()))
    expected = float(re.search(r"expected cost: (\S+) s", capsys.readouterr().out)[1])
    assert seconds[0] < expected < seconds[1]
