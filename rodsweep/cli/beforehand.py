"""Variables computed by all ranks before the result file is created, because they depend on no point."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from ..results.file.creation import Plan
from ..sweep.stop import StopRequest
from ..sweep.team import Team
from ..tasks.protocol import Task


def planned_beforehand(plan: Plan, task: Task, team: Team, stop: StopRequest) -> Plan | None:
    """The plan with its constants, computed by all ranks together; None if a stop signal came first."""
    skipped = False

    def unless_stopped(work: Callable[[Any], Any], item: Any) -> Any:
        nonlocal skipped
        skipped = skipped or bool(stop)
        return None if skipped else work(item)

    found = task.constants(lambda items, work: team.in_order(items, lambda item: unless_stopped(work, item)))
    return None if any(team.exchange(skipped)) else replace(plan, constants=lambda: found)
