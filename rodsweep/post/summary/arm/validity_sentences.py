"""Sentences on whether the model applies to an arm, and on the plane in which the arm moves."""

from collections.abc import Mapping

import numpy as np

from ....model.arm.neglected import DOUBTFUL_RATIO, Validity
from ....results.layouts.si_variables import NEGLECTED_EFFECTS, UNKNOWN_VALIDITY_NUMBER, VALIDITY_VARIABLES
from ....results.layouts.thresholds import HOPF_CROSSING_CODES
from ....wording import count_of_total, counted, two_significant_digits
from ..selection import PointSelection

OTHER_BENDING_PLANE_WARNING = (
    "the motion is in the plane of the height; where the height exceeds the width, the arm flutters first in "
    "the other plane, at a lower load: exchange width and height to compute this flutter"
)
"""Warning for a rectangular section whose height exceeds its width."""

UNKNOWN_VALIDITY_REASON = (
    "an unstable mode or a cycle may have been missed, and the neglected effects depend on the frequency of "
    "the motion"
)
"""Reason why it is not known whether the model applies."""


def bending_plane_warning(quantities: Mapping[str, np.ndarray]) -> list[str]:
    """List with the warning OTHER_BENDING_PLANE_WARNING if some arm is higher than wide, and flutters first
    in the plane that is not computed; else an empty list.

    quantities: quantities of the arm in SI units, by name, () or (n,).
    """
    height, width = (np.asarray(quantities.get(name, np.nan)) for name in ("height", "width"))
    return [OTHER_BENDING_PLANE_WARNING] if np.max(height) > np.min(width) else []


def validity_caveat(variables: Mapping[str, np.ndarray]) -> str:
    """Sentence on the validity of the model for one arm, if the model does not apply, is doubtful, or of
    unknown validity; empty if the model applies, and for a rod. variables: variables of a result with one
    point, by name, () or (1,) each."""
    if any(variable.name not in variables for variable in VALIDITY_VARIABLES):
        return ""
    validity = {variable.name: np.ravel(variables[variable.name]) for variable in VALIDITY_VARIABLES}
    return "" if validity["model_applies"][0] == Validity.applies else validity_sentence(validity)


def validity_sentence(validity: Mapping[str, np.ndarray], condition: str = "", noun: str = "point") -> str:
    """Sentence on the validity of the model at n points; if the model is not valid everywhere, with the
    largest neglected effect. validity: VALIDITY_VARIABLES by name, (n,) each. condition: clause on the motion
    that is judged, such as " at flutter". noun: "point", or "row" for rows of a phase diagram."""
    validities, effects, excesses = (validity[variable.name] for variable in VALIDITY_VARIABLES)
    is_unknown = validities == UNKNOWN_VALIDITY_NUMBER
    preposition = "on" if noun == "row" else "at"
    count = len(validities)
    everywhere_text = f" {preposition} all {counted(count, noun)}" if count > 1 else ""
    if is_unknown.all():
        return (
            f"whether the model applies is not known{everywhere_text}{condition}: {UNKNOWN_VALIDITY_REASON}"
        )
    unknown_clause = f"; not known {preposition} {count_of_total(int(is_unknown.sum()), count, noun)}"
    rest_clause = unknown_clause if is_unknown.any() else ""
    worst_validity = Validity(int(validities.max()))
    is_affected = validities == worst_validity
    somewhere_text = f" {preposition} {count_of_total(int(is_affected.sum()), count, noun)}"
    place_text = everywhere_text if is_affected.all() else somewhere_text
    if worst_validity == Validity.applies:
        return f"the model applies{place_text}{condition}{rest_clause}"
    verdict_text = "does not apply" if worst_validity == Validity.does_not_apply else "is doubtful"
    index = int(np.flatnonzero(is_affected)[np.argmax(excesses[is_affected])])
    name = NEGLECTED_EFFECTS[int(effects[index])].replace("_", " ")
    size_text = f"{'up to ' * int(is_affected.sum() > 1)}{two_significant_digits(excesses[index])}"
    limit_text = f", more than {DOUBTFUL_RATIO:g}" if worst_validity == Validity.doubtful else ""
    return (
        f"the model {verdict_text}{place_text}{condition}: {name} is {size_text} times its "
        f"limit{limit_text}{rest_clause}"
    )


def judged_row_motion_clause(rows: PointSelection) -> str:
    """Clause on the motion by which the validity of the model on rows of a phase diagram was judged: the
    motion at the first Hopf point of each row, or rest on a row without Hopf point. Empty for other tasks,
    and for rows whose motion is not known.

    Loads along a row without Hopf point do not enter; `compression_lines` compares them with the limit.
    """
    if "crossing_at" not in rows.variables:  # no rows of a phase diagram
        return ""
    judged = rows.where(rows.variables["model_applies"] != UNKNOWN_VALIDITY_NUMBER)
    has_hopf = np.isin(judged.values("crossing_kind"), HOPF_CROSSING_CODES).any(axis=-1)
    at_rest_text = "at rest" if "F" in rows.view.parameters else "at rest without load"
    if not judged.count:
        return ""
    if not has_hopf.any():
        return f", judged {at_rest_text}"
    if judged.count == 1:
        return ", judged at the first Hopf point"
    clause = ", judged at the first Hopf point of each row"
    rest_count = int((~has_hopf).sum())
    return f"{clause}, and {at_rest_text} on {counted(rest_count, 'row')} without" if rest_count else clause
