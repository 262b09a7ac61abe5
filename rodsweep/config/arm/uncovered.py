"""Arms to which the rod model does not apply: errors of `rodsweep.model.arm` that become a status of a point
in a sweep."""

from ...errors import InputError
from ...model.arm.refusals import NotSlender
from ...model.arm.section import NoWall
from .axes import NO_WALL, NOT_SLENDER

UNCOVERED = {NotSlender: NOT_SLENDER, NoWall: NO_WALL}
"""Status of a point by the error of its arm."""


class UncoveredArm(ValueError):
    """The rod model does not apply to this arm; `status` is the status of the arm's points."""

    def __init__(self, error: InputError):
        super().__init__(f"parameters.arm.{error}")
        self.status = UNCOVERED[type(error)]
