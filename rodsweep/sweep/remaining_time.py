"""Remaining time of a sweep from the number of finished points as a function of time, smoothed against jumps.

Points differ in cost: the first point of a chain has no initial guess, later points start from a neighbour, a
few points are hard. The time per point is therefore measured over the latest half of the finished points, and
never includes the first points. The reported remaining time follows the estimate slowly, with a time constant
proportional to the elapsed time, and faster toward the end. The completed fractions of unfinished points are
included. The module reads no clock: the caller passes all times.
"""

from math import exp

SKIPPED_POINT_FRACTION_FOR_PACE = 0.5
"""The time per point is measured over the points that were finished last; this fraction of all points
finished so far is skipped, because the first points have other costs."""
MIN_POINTS_FOR_PACE = 2
"""Minimum number of points finished after the first record; with fewer points there is no time per point."""
MIN_FRACTION_SUM_OF_UNFINISHED = 0.1
"""Minimum sum of the completed fractions of unfinished points, for an estimate without finished points. For
smaller sums, the time of starting up dominates."""
SMOOTHING_TIME_RATIO = 0.25
"""Time constant of the reported remaining time, divided by the smaller of elapsed and remaining time."""
POINT_COUNT_RATIO_OF_SUCCESSIVE_RECORDS = 1.02
"""Ratio of the numbers of finished points in two successive stored records: about 35 records per doubling."""


class RemainingTimeEstimator:
    """Estimator of the remaining time of a sweep of `point_count` points; all times are in s since the
    start."""

    def __init__(self, point_count: int):
        self.total = point_count
        self.records: list[tuple[int, float]] = []
        """(number of finished points, time), both increasing; the first and the latest report are stored."""
        self.reported: tuple[float, float] | None = None
        """(time of the last report, remaining time reported then)."""

    def remaining_seconds(self, finished_count: int, now: float, fraction_sum: float = 0.0) -> float | None:
        """Remaining time, in s, when `finished_count` points are finished at the time `now`, smoothed over
        the calls; None if too little work is done for an estimate. now: in s since the start of the sweep.
        fraction_sum: sum of the completed fractions of unfinished points."""
        # Without this case the smoothed time would not be 0 at the end.
        if finished_count == self.total:
            return 0.0
        if finished_count and (not self.records or finished_count > self.records[-1][0]):
            self._store_record(finished_count, now)
        seconds_per_point = self._seconds_per_point(finished_count, now, fraction_sum)
        if seconds_per_point is None:
            return None
        # Fractions of long points are estimates, and may exceed what is left.
        remaining = max(self.total - finished_count - fraction_sum, 0.0) * seconds_per_point
        if self.reported is None:
            self.reported = now, remaining
            return remaining
        last_time, reported = self.reported
        # A countdown that only passes time; the new estimate corrects it with the weight below.
        expected = max(reported - (now - last_time), 0.0)
        # A zero time constant would divide by zero when nothing is left.
        time_constant = SMOOTHING_TIME_RATIO * min(now, max(remaining, expected)) or 1.0
        weight = 1 - exp(-(now - last_time) / time_constant)
        self.reported = now, expected + weight * (remaining - expected)
        return self.reported[1]

    def _store_record(self, finished_count: int, now: float) -> None:
        """Stores the record (`finished_count`, `now`); thins earlier records to about 35 per doubling of the
        points."""
        if (
            len(self.records) > 2
            and self.records[-1][0] < POINT_COUNT_RATIO_OF_SUCCESSIVE_RECORDS * self.records[-2][0]
        ):
            # The latest record is replaced, not added to, so that a million points need some hundred records.
            self.records.pop()
        self.records.append((finished_count, now))

    def _seconds_per_point(self, finished_count: int, now: float, fraction_sum: float) -> float | None:
        """Time per point in s: the larger of the time over the latest finished points and the time that
        includes the wait since the latest record. finished_count: number of finished points. now: in s since
        the start of the sweep. fraction_sum: sum of the completed fractions of unfinished points.

        Before MIN_POINTS_FOR_PACE points are finished, the time follows from the completed fractions of
        unfinished points; None if their sum is below MIN_FRACTION_SUM_OF_UNFINISHED.
        """
        if not self.records or finished_count < self.records[0][0] + MIN_POINTS_FOR_PACE:
            # Before two points are finished only the fractions of long points show the pace.
            return (
                now / (finished_count + fraction_sum)
                if fraction_sum >= MIN_FRACTION_SUM_OF_UNFINISHED
                else None
            )
        earlier_records = (
            record
            for record in reversed(self.records)
            if record[0] <= SKIPPED_POINT_FRACTION_FOR_PACE * finished_count
        )
        earlier_points, earlier_time = next(earlier_records, self.records[0])
        latest_time = self.records[-1][1]
        new_points = finished_count - earlier_points
        # While a long point runs, the time since the last record shows that the pace has dropped.
        return max(
            (latest_time - earlier_time) / new_points,
            (now - earlier_time) / (new_points + (fraction_sum or 1.0)),
        )


def duration_text(seconds: float) -> str:
    """Text of a duration with at most two significant digits: 8 s, 1.5 min, 3.2 h, 12 d."""
    for unit, length in (("d", 86400.0), ("h", 3600.0), ("min", 60.0)):
        # Up to 1.45 of a unit the smaller unit has the finer digits: 85 min instead of 1.4 h.
        if seconds >= 1.45 * length:
            return f"{float(f'{seconds / length:.2g}'):g} {unit}"
    return f"{float(f'{seconds:.2g}'):.0f} s"


def rate_in_words(finished_count: int, seconds: float) -> str:
    """Text of the rate of `finished_count` points in `seconds`: points per second, or the time per point if
    this time exceeds one second. Empty before the first point."""
    if not finished_count or not seconds:
        return ""
    rate = finished_count / seconds
    return f"{rate:.3g}/s" if rate >= 1 else f"{duration_text(1 / rate)} per point"
