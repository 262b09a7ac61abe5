"""The stages that know a task, each with one module and one entry a task, and no generic module that asks."""

import re
from pathlib import Path

import pytest

import rodsweep
from rodsweep.config.tasks import CONFIG_CLASSES_BY_TASK
from rodsweep.post.figures import DRAW_FUNCTION_BY_TASK
from rodsweep.post.summary import SUMMARY_FUNCTION_BY_TASK
from rodsweep.results.layouts import LAYOUT_MAKERS
from rodsweep.tasks import TASKS

PACKAGE = Path(rodsweep.__file__).parent
STAGES = {
    "config/task": CONFIG_CLASSES_BY_TASK,
    "results/layouts": LAYOUT_MAKERS,
    "tasks": TASKS,
    "post/summary": SUMMARY_FUNCTION_BY_TASK,
    "post/figures": DRAW_FUNCTION_BY_TASK,
}
"""The registry of every stage, by its directory."""


@pytest.mark.parametrize("stage", STAGES)
def test_every_stage_knows_the_same_tasks(stage):
    assert STAGES[stage].keys() == CONFIG_CLASSES_BY_TASK.keys()


@pytest.mark.parametrize("stage", STAGES)
def test_every_stage_has_a_module_of_the_name_of_every_task(stage):
    for task in CONFIG_CLASSES_BY_TASK:
        assert (PACKAGE / stage / f"{task}.py").is_file()


def test_no_module_asks_which_task_it_is():
    asks = re.compile(r"""\btask(\(\))?("\]|'\])? *(==|!=|in) *["'(\[{]""")
    for path in PACKAGE.rglob("*.py"):
        assert not asks.search(path.read_text()), path
