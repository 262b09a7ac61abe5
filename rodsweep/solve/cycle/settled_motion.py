"""A motion that has settled on a cycle, the clock of its returns, and the exception for a motion without a
cycle."""

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


class ReturnClock:
    """Times of the returns of the tip to theta = 0 during successive runs of one motion.

    shortest: smallest value of `time_per_return`, in tau2, the period of the leading mode. time_per_return:
    expected time per return, in tau2: the time between the last two returns, or `shortest` if it is longer. A
    slow-fast cycle may take many time constants of a leading mode that does not oscillate."""

    def __init__(self, shortest: float) -> None:
        self.shortest = self.time_per_return = shortest
        self._elapsed = 0.0
        self._last_return: float | None = None

    def record_run(self, times: Array, duration: float) -> None:
        """Records a run that follows the earlier runs. times: times of the returns during the run, (k,).
        duration: length of the run. Times are in tau2."""
        for time in (self._elapsed + times).tolist():
            if self._last_return is not None:
                self.time_per_return = max(self.shortest, time - self._last_return)
            self._last_return = time
        self._elapsed += duration


class NoCycleFound(Exception):
    """Raised if the motion does not settle on a cycle. status, message: outcome of the motion."""

    def __init__(self, status: MarchedStatus, message: str) -> None:
        super().__init__(message)
        self.status = status
        self.message = message
