"""The stages that know a task, each with one module and one entry a task."""

from pathlib import Path

import pytest

import rodsweep
from rodsweep.cli.tasks import TASKS
from rodsweep.config.tasks import CONFIGS
from rodsweep.results.layouts import LAYOUTS

PACKAGE = Path(rodsweep.__file__).parent
STAGES = {
    "config": CONFIGS,
    "results/layouts": LAYOUTS,
    "cli/tasks": TASKS,
}
"""The registry of every stage, by its directory."""


@pytest.mark.parametrize("stage", STAGES)
def test_every_stage_knows_the_same_tasks(stage):
    assert list(STAGES[stage]) == list(CONFIGS)


@pytest.mark.parametrize("stage", STAGES)
def test_every_stage_has_a_module_of_the_name_of_every_task(stage):
    for task in CONFIGS:
        assert (PACKAGE / stage / f"{task}.py").is_file() or (PACKAGE / stage / task).is_dir()
