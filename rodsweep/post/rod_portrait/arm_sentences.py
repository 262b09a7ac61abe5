"""Sentences about an arm in the portrait of a rod: the units of the arm, and whether the model applies to the
arm."""

from collections.abc import Iterator

import numpy as np

from ...model.arm.neglected import Validity
from ...results.file.view import ResultView
from ...results.layouts.si_variables import VALIDITY_VARIABLES
from ..summary.arm.validity_sentences import bending_plane_warning, validity_caveat, validity_sentence
from .results import RodResults


def arm_sentences(results: RodResults) -> Iterator[str]:
    """Yields sentences on the units of an arm, the validity of the model at flutter and on the branches of
    cycles, and the plane of motion."""
    view = results.views["thresholds"]
    quantities = {name: float(values.ravel()[0]) for name, values in view.quantities.items()}
    force, pressure, time = (quantities[name] for name in ("force_scale", "pressure_scale", "tau2"))
    pressure_text = f"a pressure of {pressure:.6g} Pa on the face of its tip"
    yield f"F = 1 stands for {force:.6g} N, or {pressure_text}, and tau2 for {time:.6g} s."
    validity = {variable.name: view.flattened_by_point(variable.name) for variable in VALIDITY_VARIABLES}
    flutter_clause = " at flutter" if np.isfinite(view.variables["F_hopf"]).all() else ""
    branch = results.views.get("branch")
    caveat_text = validity_caveat(branch.variables) if branch else ""
    on_branches = [f"somewhere on its branches of cycles {caveat_text}"] if caveat_text else []
    sentences = [
        validity_sentence(validity, flutter_clause),
        *on_branches,
        *bending_plane_warning(view.quantities),
    ]
    yield from (f"{sentence[0].upper()}{sentence[1:]}." for sentence in sentences)


def cycle_validity_caveat(view: ResultView) -> str:
    """Sentence in brackets, after a blank, if the model does not apply to the cycle of an arm; else an empty
    text."""
    validity = view.variables.get("model_applies")
    if validity is None or (validity != Validity.does_not_apply).any():
        return ""
    return f" ({validity_caveat(view.variables)})"
