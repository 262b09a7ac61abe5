"""What the ranks of a run compute before its file is created: the variables that need no point."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from ..results.file.creation import Plan
from ..sweep.stop import StopRequest
from ..sweep.team import Team
from ..tasks.protocol import Task


def planned_beforehand(plan: Plan, task: Task, team: Team, stop: StopRequest) -> Plan | None:
    """The plan with its constants, which all ranks have shared; None where a stop came before they were."""
    skipped = False

    def unless_stopped(work: Callable[[Any], Any], item: Any) -> Any:
        nonlocal skipped
        skipped = skipped or bool(stop)
        return None if skipped else work(item)

    found = task.constants(lambda items, work: team.in_order(items, lambda item: unless_stopped(work, item)))
    return None if any(team.exchange(skipped)) else replace(plan, constants=lambda: found)
