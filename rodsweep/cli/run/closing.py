"""Closing sentences of a run: the time of points and curves, and what a stopped run keeps."""

from dataclasses import dataclass

from ...wording import counted, duration


@dataclass(frozen=True, slots=True, kw_only=True)
class RunEnd:
    """Counts and times at the end of a run.

    asked: points to solve. left: points not solved. kept: points in the file. seconds: time of the points.
    curve_seconds: time of the variables that need all points. in_the_middle: points interrupted
    by a stop. followed: halves of curves followed in this run, None if no curves were due. halves: halves
    kept while the curves are incomplete, else None.
    """

    ranks: int
    asked: int
    left: int
    kept: int
    seconds: float
    curve_seconds: float
    in_the_middle: int
    followed: int | None
    halves: int | None

    def times(self) -> list[str]:
        """Sentences on the times of points and curves; empty if there was nothing to do."""
        sentences = []
        ranks = counted(self.ranks, "rank")
        if self.asked:
            points = self.asked - self.left
            each = self.seconds * self.ranks / max(points, 1)
            pace = f" ({duration(each)} a point and rank)" if points else ""
            sentences.append(f"{counted(points, 'point')} in {self.seconds:.2f} s on {ranks}{pace}")
        if self.followed is not None:
            word = "curves in" if self.halves is None else "curves stopped after"
            halves = "half of a curve" if self.followed == 1 else "halves of curves"
            done = f"; {self.followed} {halves} of cycles followed" if self.followed else ""
            sentences.append(f"{word} {self.curve_seconds:.2f} s on {ranks}{done}")
        return sentences

    def kept_words(self) -> str:
        """Words on what a stopped run keeps."""
        points = f"{counted(self.kept, 'point')} kept"
        if self.halves is not None:
            return f"{points}, the curves are missing, {self.halves} of their halves kept"
        if self.in_the_middle:
            return f"{points}, {self.in_the_middle} interrupted, to be solved again"
        return points
