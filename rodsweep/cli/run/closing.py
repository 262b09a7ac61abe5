"""What a run says of its end: how long points and curves took, and what is kept where it was stopped."""

from dataclasses import dataclass

from ...wording import counted, duration


@dataclass(frozen=True, slots=True, kw_only=True)
class RunEnd:
    """How a run ended.

    asked: points that were to do; left: those of them that still are; kept: points in the file. seconds: of
    the points; curve_seconds: of what all of them together give. in_the_middle: points that a stop ended.
    followed: halves of curves of this run, None where no curves were due; halves: those that are kept while
    the curves are missing, None where they are not.
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
        """Sentences about the times of points and curves; none where there was nothing to do."""
        sentences, ranks = [], counted(self.ranks, "rank")
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
        """What is kept of a run that was stopped."""
        points = f"{counted(self.kept, 'point')} kept"
        if self.halves is not None:
            return f"{points}, the curves are missing, {self.halves} of their halves kept"
        if self.in_the_middle:
            return f"{points}, {self.in_the_middle} left in the middle and solved again"
        return points
