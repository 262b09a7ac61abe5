"""Status codes of the points of an arm: whether the rod model applies, and why not."""

from ...errors import InputError
from ...model.arm.refusals import NotSlender
from ...model.arm.section import BoreTooWide

SLENDER, NOT_SLENDER, CRUSHED, NO_WALL, NO_FLUTTER, FLUTTER_UNKNOWN = 0, 100, 101, 102, 103, 104
"""Status codes of the points of an arm, in this order: the rod model applies; the arm is too short for the
drag of slender bodies; F >= k1; the bore is as wide as the arm; the load is relative to a flutter threshold
that does not exist; the load is relative to a flutter threshold that the search did not find. The codes from
100 on are larger than the status codes of all tasks."""
STATUS_OF_ERROR = {NotSlender: NOT_SLENDER, BoreTooWide: NO_WALL}
"""Status code of a point by the class of the exception that its arm raises."""


class ArmOutsideModel(ValueError):
    """The rod model does not apply to an arm; `status` is the status code of the arm's points."""

    def __init__(self, error: InputError):
        super().__init__(f"parameters.arm.{error}")
        self.status = STATUS_OF_ERROR[type(error)]
