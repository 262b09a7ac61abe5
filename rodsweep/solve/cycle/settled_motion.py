"""A motion that has settled on a cycle, and the exception for a motion without a cycle."""

from dataclasses import dataclass

from ...arrays import Array
from .status import MarchedStatus


@dataclass(frozen=True, eq=False)
class SettledMotion:
    """A motion that has settled on a cycle. state: present state of the beam, (unknowns,).
    returns_per_period: number of returns of the tip to theta = 0 per period. last_time_step: last time step,
    in tau2."""

    state: Array
    returns_per_period: int
    last_time_step: float


class NoCycleFound(Exception):
    """Raised if the motion does not settle on a cycle. status, message: outcome of the motion."""

    def __init__(self, status: MarchedStatus, message: str) -> None:
        super().__init__(message)
        self.status = status
        self.message = message
