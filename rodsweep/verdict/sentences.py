"""The verdict on an arm in plain sentences: whether it flutters, how fast it beats, whether it returns."""

from ..model.arm import UNITS, SlenderArm
from ..model.units import unit_of, written_in
from ..solve.changes.unstable_modes import Kind
from .flutter import FlutterRange, Span


def rounded(low: float, high: float) -> str:
    """A range to three digits; one number where its ends look alike."""
    ends = [f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}" for value in (low, high)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


class Load:
    """What pushes the arm, in the words and the unit in which it was given."""

    def __init__(self, arm: SlenderArm):
        self.name = "force" if arm.pressure is None else "pressure"
        given, si = getattr(arm, self.name), UNITS[self.name][0]
        self.unit = unit_of(given, si)
        self.given = given.strip() if isinstance(given, str) else f"{given:g} {si}"
        area = arm.section.area if self.name == "pressure" else 1.0
        self.scale = written_in(arm.force_scale / area, self.unit, si)
        """How much of it F = 1 is."""

    def of(self, forces: Span) -> str:
        """A range of forces in k3/L^2, as this load."""
        return f"{rounded(forces.low * self.scale, forces.high * self.scale)} {self.unit}"


def verdict_sentences(arm: SlenderArm, found: FlutterRange) -> list[str]:
    """What becomes of the arm, over the range of its drag."""
    load = Load(arm)
    if found.failures:
        return ["The thresholds could not be found with every drag: " + "; ".join(found.failures) + "."]
    flutter, back = found.force(Kind.hopf), found.force(Kind.restabilization)
    if flutter is None:
        return [no_flutter(arm, found, load)]
    rate = found.frequency(Kind.hopf)
    says = [place_of(arm, found, flutter, load)]
    if rate is not None:
        says.append(
            f"Above, the straight arm gives way and begins to beat at {rounded(rate.low, rate.high)} Hz."
        )
    if not flutter.always:
        says.append("Part of the range of drag has no flutter at all.")
    if back is not None:
        some = "" if back.always else ", with part of the range of drag"
        says.append(f"The straight arm returns at {load.of(back)}{some}.")
    else:
        says.append(f"The straight arm does not return {until(arm, found, load)}.")
    return says + swinging(found, load)


def place_of(arm: SlenderArm, found: FlutterRange, flutter: Span, load: Load) -> str:
    """Where the load lies beside the range of flutter."""
    F, where = arm.F, load.of(flutter)
    if F <= 0:
        return f"Flutter is at {where}; {load.given} does not push, and the arm stays straight."
    if flutter.low > F:
        percent = rounded_percent(1 - F / flutter.low, 1 - F / flutter.high)
        return f"{load.given} is {percent} % below flutter, at {where}: the arm stays straight."
    if found.end < F:
        end = load.of(Span(found.end, found.end))
        unknown = f"whether the arm beats at {load.given} is not known"
        return f"Flutter is at {where}; {unknown}: changes were sought up to {end}."
    unstable = found.unstable_at(F)
    if flutter.high < F and not any(unstable):
        return f"{load.given} is beyond flutter, at {where}: the straight arm has returned."
    if not all(unstable):
        return f"{load.given} lies in the range of flutter, {where}: drag decides whether the arm beats."
    low, high = (F / edge for edge in (flutter.high, flutter.low))
    above = f"{rounded(low, high)} times" if low > 2 else f"{rounded_percent(low - 1, high - 1)} % above"
    return f"{load.given} is {above} flutter, at {where}: the arm beats."


def rounded_percent(low: float, high: float) -> str:
    """A range of shares in percent, without decimals but for small ones."""
    percents = [100 * value for value in sorted((low, high))]
    ends = [f"{value:.0f}" if value >= 1 else f"{value:.1g}" for value in percents]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


def no_flutter(arm: SlenderArm, found: FlutterRange, load: Load) -> str:
    """Where nothing becomes unstable."""
    return f"The arm does not flutter {until(arm, found, load)}: it stays straight at {load.given}."


def until(arm: SlenderArm, found: FlutterRange, load: Load) -> str:
    """How far changes were sought."""
    end = load.of(Span(found.end, found.end))
    if found.end > 0.999 * arm.k1:
        return f"before it is crushed at {end}"
    return f"up to {end}, where the search ends"


def swinging(found: FlutterRange, load: Load) -> list[str]:
    """From where on a disturbance swings while it dies away."""
    onset = found.force(Kind.onset)
    return [] if onset is None else [f"From {load.of(onset)} on a disturbance swings as it dies away."]
