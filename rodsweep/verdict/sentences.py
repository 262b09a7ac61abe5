"""Verdict on an arm in sentences: flutter load, frequency of beating, return to stability.

The first sentence is the headline. If the model does not apply at the flutter threshold, the headline says
so, and the sentences on flutter are conditional: "Without inertia the arm would flutter ...".
"""

from ..model.arm.neglected import Validity
from ..solve.changes.threshold_kinds import ThresholdKind
from .flutter_over_drags import RangeOverDrags, ThresholdsOverDrags
from .load_texts import LoadFormatter, percent_range_text, three_digit_range_text
from .planes import PlaneOfMotion, PlanesOfMotion
from .remedies import effect_kind, not_applicable_sentences
from .validity_assessment import ValidityAssessment

MIN_CRUSHED_END_OVER_CRUSHING_FORCE = 0.999
"""A search ended because of crushing if its largest force, divided by the crushing force, exceeds this
number."""


def verdict_sentences(planes: PlanesOfMotion, assessment: ValidityAssessment) -> list[str]:
    """Sentences of the verdict on an arm, over the range of drag: whether the model applies, why thresholds
    are uncertain (if they are), flutter in the plane with the smaller flutter load, then in the second plane.
    The second plane is left out if the model applies at flutter but not under the load. If a search in the
    first plane failed, the list contains only the reason."""
    plane = planes.first_to_flutter
    if plane.thresholds.failure_texts:
        return [
            "For some drags the thresholds could not be found: "
            + "; ".join(plane.thresholds.failure_texts)
            + "."
        ]
    headline, *others = _sentences_if_search_succeeded(planes, assessment)
    known_planes = [plane for plane in (planes.first_to_flutter, planes.second) if plane is not None]
    doubts = sorted({doubt for plane in known_planes for doubt in plane.thresholds.uncertainty_reasons})
    doubt_sentences = [f"For some drags this is not certain: {'; '.join(doubts)}."] if doubts else []
    return [headline, *doubt_sentences, *others]


def _sentences_if_search_succeeded(planes: PlanesOfMotion, assessment: ValidityAssessment) -> list[str]:
    """Sentences of the verdict if no search in the first plane failed: see `verdict_sentences`."""
    plane = planes.first_to_flutter
    invalid_effects = assessment.effects_with(Validity.does_not_apply)
    if not invalid_effects:
        return [*_valid_arm_sentences(plane), *_second_plane_sentences(planes, "is")]
    headline = not_applicable_sentences(plane.arm, assessment)
    if assessment.validity_at_flutter == Validity.does_not_apply:
        kinds = " and ".join(dict.fromkeys(map(effect_kind, invalid_effects)))
        return [
            *headline,
            *_flutter_without_effects_sentences(plane, kinds),
            *_second_plane_sentences(planes, "would be"),
        ]
    flutter = plane.thresholds.first_force_range(ThresholdKind.hopf)
    flutter_text = (
        "No flutter was found" if flutter is None else f"Flutter, at {_flutter_load_text(plane, flutter)},"
    )
    return [*headline, f"{flutter_text} is within the model; {LoadFormatter(plane.arm).typed_text} is not."]


def _valid_arm_sentences(plane: PlaneOfMotion) -> list[str]:
    """Sentences on flutter and return to stability of an arm to which the model applies."""
    arm = plane.arm
    thresholds = plane.thresholds
    load = LoadFormatter(plane.arm)
    flutter = thresholds.first_force_range(ThresholdKind.hopf)
    restabilization = thresholds.first_force_range(ThresholdKind.restabilization)
    if flutter is None:
        consequence = f": it stays straight at {load.typed_text}" if load.typed_text else ""
        if thresholds.end < arm.F:
            consequence = f": whether the arm beats at {load.typed_text} is not known"
        return [f"The arm does not flutter {_search_end_clause(plane, load)}{consequence}."]
    clause = _beating_clause(thresholds, " begins")
    if arm.load_name is None:
        sentences = [
            f"The arm flutters at {_flutter_load_text(plane, flutter)}: above, it gives way and{clause}."
        ]
    else:
        sentences = [
            _load_comparison_sentence(plane, flutter, load),
            f"Above, the straight arm gives way and{clause}.",
        ]
    if not flutter.exists_for_every_drag:
        sentences.append("For part of the range of drag the arm does not flutter at all.")
    if restabilization is not None:
        drag_note = "" if restabilization.exists_for_every_drag else ", for part of the range of drag"
        loads = f"{load.range_of_forces_text(restabilization)}{drag_note}"
        sentences.append(
            f"The straight arm is stable again above {loads}{_second_flutter_clause(thresholds, load)}."
        )
    else:
        sentences.append(f"The straight arm does not become stable again {_search_end_clause(plane, load)}.")
    return sentences + _oscillation_onset_sentences(thresholds, load)


def _beating_clause(thresholds: ThresholdsOverDrags, begins: str) -> str:
    """Clause on the frequency of flutter, after the verb `begins`; empty if the frequency is not known."""
    frequency = thresholds.first_frequency_range(ThresholdKind.hopf)
    if frequency is None:
        return ""
    return f"{begins} to beat at {three_digit_range_text(frequency.low, frequency.high)} Hz"


def _second_flutter_clause(thresholds: ThresholdsOverDrags, load: LoadFormatter) -> str:
    """Clause on the load at which an arm that is stable again flutters a second time; empty if it does not
    flutter again."""
    forces = thresholds.second_flutter_force_range
    if forces is None:
        return ""
    drag_clause = "" if forces.exists_for_every_drag else ", for part of the range of drag"
    return f", and flutters again above {load.range_of_forces_text(forces)}{drag_clause}"


def _flutter_load_text(plane: PlaneOfMotion, flutter: RangeOverDrags) -> str:
    """Range of the flutter load over the drags as text; for a rectangular section, followed by the name of
    the plane of motion."""
    load_text = LoadFormatter(plane.arm).range_of_forces_text(flutter)
    return f"{load_text} in {plane.name}" if plane.name else load_text


def _load_comparison_sentence(plane: PlaneOfMotion, flutter: RangeOverDrags, load: LoadFormatter) -> str:
    """Sentence that compares the arm's load with the range of the flutter load over the drags and says
    whether the arm beats."""
    F = plane.arm.F
    thresholds = plane.thresholds
    load_text = _flutter_load_text(plane, flutter)
    if F <= 0:
        return f"Flutter is at {load_text}; {load.typed_text} does not push, and the arm stays straight."
    if flutter.low > F:
        percent = percent_range_text(1 - F / flutter.low, 1 - F / flutter.high)
        return f"{load.typed_text} is {percent} % below flutter, at {load_text}: the arm stays straight."
    if thresholds.end < F:
        end = load.range_of_forces_text(RangeOverDrags(thresholds.end, thresholds.end))
        unknown_clause = f"whether the arm beats at {load.typed_text} is not known"
        return f"Flutter is at {load_text}; {unknown_clause}: thresholds were searched only up to {end}."
    is_unstable_by_drag = [drag.is_unstable_at(F) for drag in thresholds.by_drag]
    if flutter.high < F and not any(is_unstable_by_drag):
        return f"{load.typed_text} is beyond flutter, at {load_text}: the straight arm is stable again."
    if not all(is_unstable_by_drag):
        typed = load.typed_text
        return f"{typed} lies in the range of flutter, {load_text}: drag decides whether the arm beats."
    return f"{load.typed_text} is {_excess_text(F, flutter)} flutter, at {load_text}: the arm beats."


def _excess_text(F: float, flutter: RangeOverDrags) -> str:
    """Excess of the force F over the range of the flutter load, as text: "20 to 30 % above", or "3 times" if
    F is more than twice the largest flutter load."""
    low, high = (F / end for end in (flutter.high, flutter.low))
    return (
        f"{three_digit_range_text(low, high)} times"
        if low > 2
        else f"{percent_range_text(low - 1, high - 1)} % above"
    )


def _flutter_without_effects_sentences(plane: PlaneOfMotion, effect_names: str) -> list[str]:
    """Sentences on the flutter that an arm outside the model would have without the effects
    `effect_names`."""
    arm = plane.arm
    thresholds = plane.thresholds
    load = LoadFormatter(plane.arm)
    flutter = thresholds.first_force_range(ThresholdKind.hopf)
    if flutter is None:
        return [f"Without {effect_names} the arm would not flutter {_search_end_clause(plane, load)}."]
    clause = _beating_clause(thresholds, " and begin")
    sentences = [
        f"Without {effect_names} the arm would flutter at {_flutter_load_text(plane, flutter)}{clause}."
    ]
    if arm.load_name is None or arm.F <= 0:
        return sentences
    if flutter.low > arm.F:
        position = f"{percent_range_text(1 - arm.F / flutter.low, 1 - arm.F / flutter.high)} % below"
    elif flutter.high < arm.F:
        position = _excess_text(arm.F, flutter)
    else:
        position = "inside the range of"
    return [*sentences, f"{load.typed_text} would be {position} that threshold."]


def _second_plane_sentences(planes: PlanesOfMotion, verb: str) -> list[str]:
    """List of one sentence on flutter in the second plane of a rectangular section; empty for other sections.
    verb: "is" or "would be"."""
    second_plane = planes.second
    if second_plane is None:
        return []
    if second_plane.thresholds.failure_texts:
        return [f"The threshold in {second_plane.name} could not be found."]
    load = LoadFormatter(second_plane.arm)
    flutter = second_plane.thresholds.first_force_range(ThresholdKind.hopf)
    if flutter is None:
        return [f"In {second_plane.name} there {verb} no flutter {_search_end_clause(second_plane, load)}."]
    drag_clause = ""
    if not planes.is_first_lowest_for_every_drag:
        drag_clause = "; for part of the range of drag, flutter starts in this plane"
    return [f"In {second_plane.name} flutter {verb} at {load.range_of_forces_text(flutter)}{drag_clause}."]


def _search_end_clause(plane: PlaneOfMotion, load: LoadFormatter) -> str:
    """Clause that states the load at which the search ends, and whether this load crushes the arm."""
    end = load.range_of_forces_text(RangeOverDrags(plane.thresholds.end, plane.thresholds.end))
    if plane.thresholds.end > MIN_CRUSHED_END_OVER_CRUSHING_FORCE * plane.arm.crushing_force:
        return f"before it is crushed at {end}"
    return f"up to {end}, where the search ends"


def _oscillation_onset_sentences(thresholds: ThresholdsOverDrags, load: LoadFormatter) -> list[str]:
    """Sentence on the loads at which a decaying disturbance oscillates; empty if no such load was found."""
    onset = thresholds.first_force_range(ThresholdKind.onset)
    if onset is None:
        return []
    end = thresholds.first_force_range(ThresholdKind.real_again)
    flutter = thresholds.first_force_range(ThresholdKind.hopf)
    range_text = f"From {load.range_of_forces_text(onset)} on"
    # Otherwise a window of flutter may lie between onset and end.
    if end is not None and (flutter is None or end.high < flutter.low):
        drag_note = "" if end.exists_for_every_drag else " for part of the range of drag"
        range_text += f", up to {load.range_of_forces_text(end)}{drag_note}"
    return [f"{range_text}, a disturbed arm oscillates as it returns to rest."]
