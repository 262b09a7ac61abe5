"""Sentences on whether the model applies to an arm, and on the plane in which the arm moves."""

from collections.abc import Mapping

import numpy as np

from ....model.arm.neglected import DOUBTFUL_RATIO, Validity
from ....results.layouts.arm import NEGLECTED_EFFECTS, VALIDITY_NOT_KNOWN, VALIDITY_VARIABLES
from ....wording import count_of_total

OTHER_PLANE = (
    "the motion is in the plane of the height; where the height exceeds the width, the arm flutters first in "
    "the other plane, at a lower load: exchange width and height to compute it"
)
"""Warning for a rectangular section whose height exceeds its width."""

MISSED_MOTION = (
    "an unstable mode or a cycle may have been missed, and the neglected effects depend on its frequency"
)
"""Reason why it is not known whether the model applies."""


def plane_lines(quantities: Mapping[str, np.ndarray]) -> list[str]:
    """List with the warning OTHER_PLANE if some arm is higher than wide, and flutters first in the plane that
    is not computed; else an empty list.

    quantities: quantities of the arm in SI units, by name, () or (n,).
    """
    height, width = (np.asarray(quantities.get(name, np.nan)) for name in ("height", "width"))
    return [OTHER_PLANE] if np.max(height) > np.min(width) else []


def validity_caveat(variables: Mapping[str, np.ndarray]) -> str:
    """Sentence on the validity of the model for one arm, if the model does not apply, is doubtful, or this
    is not known; empty if the model applies, and for a rod. variables: variables of a result with one
    point, by name, () or (1,) each."""
    if any(variable.name not in variables for variable in VALIDITY_VARIABLES):
        return ""
    validity = {variable.name: np.ravel(variables[variable.name]) for variable in VALIDITY_VARIABLES}
    return "" if validity["model_applies"][0] == Validity.applies else validity_sentence(validity)


def validity_sentence(validity: Mapping[str, np.ndarray], condition: str = "") -> str:
    """Sentence on the validity of the model at n points; if the model is not valid everywhere, with the
    largest neglected effect. validity: VALIDITY_VARIABLES by name, (n,) each. condition: conditional clause.
    """
    validities, effects, excesses = (validity[variable.name] for variable in VALIDITY_VARIABLES)
    unknown = validities == VALIDITY_NOT_KNOWN
    if unknown.all():
        points_text = f" at all {len(validities)} points" if len(validities) > 1 else ""
        return f"whether the model applies is not known{points_text}{condition}: {MISSED_MOTION}"
    rest = (
        f"; not known at {count_of_total(int(unknown.sum()), len(validities), 'point')}"
        if unknown.any()
        else ""
    )
    worst_validity = Validity(int(validities.max()))
    is_affected = validities == worst_validity
    place = f" at {count_of_total(int(is_affected.sum()), len(validities), 'point')}"
    if is_affected.all():
        place = "" if len(validities) == 1 else f" at all {len(validities)} points"
    if worst_validity == Validity.applies:
        all_points = " at all points" if len(validities) > 1 else ""
        return f"the model applies{all_points if is_affected.all() else place}{condition}{rest}"
    verdict = "does not apply" if worst_validity == Validity.does_not_apply else "is doubtful"
    index = int(np.flatnonzero(is_affected)[np.argmax(excesses[is_affected])])
    name = NEGLECTED_EFFECTS[int(effects[index])].replace("_", " ")
    size = f"{'up to ' * int(is_affected.sum() > 1)}{excesses[index]:.2g}"
    limit_text = f", more than {DOUBTFUL_RATIO:g}" if worst_validity == Validity.doubtful else ""
    return f"the model {verdict}{place}{condition}: {name} is {size} times its limit{limit_text}{rest}"
