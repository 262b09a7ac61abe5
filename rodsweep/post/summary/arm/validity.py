"""Whether the model applies to an arm, and in which plane the arm moves, in sentences."""

from collections.abc import Mapping

import numpy as np

from ....model.arm.neglected import Validity
from ....results.layouts.arm import EFFECTS, NOT_KNOWN, VALIDITY
from ....wording import some_of

OTHER_PLANE = (
    "the motion is in the plane of the height; where that is above the width, the arm flutters first in the "
    "other plane, at a lower load: exchange width and height to see it"
)
"""Warning about a rectangular section of greater height than width."""


def plane_lines(quantities: Mapping[str, np.ndarray]) -> list[str]:
    """Warning if some rectangular section flutters first in the plane that is not computed; else empty.

    quantities: quantities of an arm, in SI units, each a number or (n,).
    """
    height, width = (np.asarray(quantities.get(name, np.nan)) for name in ("height", "width"))
    return [OTHER_PLANE] if np.max(height) > np.min(width) else []


def validity_sentence(validity: Mapping[str, np.ndarray], when: str = "") -> str:
    """Sentence on the validity of the model at points, with the largest neglected effect.

    validity: the variables of VALIDITY, (n,). when: condition of the validity, as a clause.
    """
    applies, effect, excess = (validity[variable.name] for variable in VALIDITY)
    unknown = applies == NOT_KNOWN
    if unknown.all():
        where = f" at all {len(applies)} points" if len(applies) > 1 else ""
        return f"whether the model applies is not known{where}{when}: a motion may have been missed"
    rest = f"; not known at {some_of(int(unknown.sum()), len(applies), 'point')}" if unknown.any() else ""
    worst = Validity(int(applies.max()))
    affected = applies == worst
    at = f" at {some_of(int(affected.sum()), len(applies), 'point')}"
    if affected.all():
        at = "" if len(applies) == 1 else f" at all {len(applies)} points"
    if worst == Validity.applies:
        everywhere = " at all points" if len(applies) > 1 else ""
        return f"the model applies{everywhere if affected.all() else at}{when}{rest}"
    verb = "does not apply" if worst == Validity.does_not_apply else "is doubtful"
    place = int(np.flatnonzero(affected)[np.argmax(excess[affected])])
    name = EFFECTS[int(effect[place])].replace("_", " ")
    size = f"{'up to ' * int(affected.sum() > 1)}{excess[place]:.2g}"
    return f"the model {verb}{at}{when}: {name} is {size} times its limit{rest}"
