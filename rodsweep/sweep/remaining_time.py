"""How long a sweep will still take, from how many points were done when: a number that does not jump.

Points cost unlike: the first of a chain is cold, others start from a neighbour, some are hard. So the pace is
that of the later half of what is done, and never of what is heard of first, the cold start. What is told
follows it slowly, by a share of the time that has passed, and faster the nearer the end is. Where points are
long, the share that is done of those that are being solved counts, too. Knows no clock.
"""

from math import exp

FORGET = 0.5
"""Fraction of the finished points, the latest ones, from which the pace is measured."""
FEWEST = 2
"""Points, after those that are heard of first, after which anything is said."""
LEAST_BEGUN = 0.1
"""Share of a long point that has to be done before the time left is told: earlier its start would decide."""
SLOWNESS = 0.25
"""Time constant with which the reported time left follows its estimate, as a fraction of the time passed or
left, whichever is shorter."""
THINNED = 1.02
"""Ratio of points done between records that are kept: some 35 for each doubling."""


class Pace:
    """The time left of `total` points; times are in s since the start."""

    def __init__(self, total: int):
        self.total = total
        self.records: list[tuple[int, float]] = []
        """(points done, time), both increasing: what was heard of first, ..., the latest."""
        self.told: tuple[float, float] | None = None
        """(time, what was said to be left then)."""

    def left(self, done: int, now: float, begun: float = 0.0) -> float | None:
        """The time left when `done` points are done at the time `now`; None where too little is.

        begun: how much is done of the points that are being solved, in points.
        """
        if done == self.total:
            return 0.0
        if done and (not self.records or done > self.records[-1][0]):
            self._record(done, now)
        each = self._each(done, now, begun)
        if each is None:
            return None
        found = max(self.total - done - begun, 0.0) * each
        if self.told is None:
            self.told = now, found
            return found
        before, said = self.told
        expected = max(said - (now - before), 0.0)
        within = SLOWNESS * min(now, max(found, expected)) or 1.0
        follow = 1 - exp(-(now - before) / within)
        self.told = now, expected + follow * (found - expected)
        return self.told[1]

    def _record(self, done: int, now: float) -> None:
        """Keeps the latest, and of those before a few for each doubling."""
        if len(self.records) > 2 and self.records[-1][0] < THINNED * self.records[-2][0]:
            self.records.pop()
        self.records.append((done, now))

    def _each(self, done: int, now: float, begun: float) -> float | None:
        """Time a point over the latest FORGET of what is done; longer while the next one takes longer.

        Before FEWEST points are done it is that of what is begun; None where that is too little.
        """
        if not self.records or done < self.records[0][0] + FEWEST:
            return now / (done + begun) if begun >= LEAST_BEGUN else None
        half = (record for record in reversed(self.records) if record[0] <= FORGET * done)
        points, began = next(half, self.records[0])
        latest = self.records[-1][1]
        return max((latest - began) / (done - points), (now - began) / (done - points + (begun or 1.0)))


def in_words(seconds: float) -> str:
    """A time as one says it, to two digits at most: 8 s, 1.5 min, 3.2 h, 12 d."""
    for unit, length in (("d", 86400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds >= 1.45 * length:
            return f"{float(f'{seconds / length:.2g}'):g} {unit}"
    return f"{float(f'{seconds:.2g}'):.0f} s"


def rate_in_words(done: int, seconds: float) -> str:
    """How many points a time are done, or how long one takes where that is more than a second."""
    if not done or not seconds:
        return ""
    rate = done / seconds
    return f"{rate:.3g}/s" if rate >= 1 else f"{in_words(1 / rate)} a point"
