"""Pictures of the leading eigenvalues in the complex plane, and of the shape of the leading mode."""

from typing import Any

import numpy as np

from . import card
from .numbers_table import SI_VARIABLE_BY_DIMENSIONLESS_NAME


class SpectrumPicture:
    """Eigenvalues of the straight rod in the complex plane. Eigenvalues to the right of the imaginary axis
    (the dashed line) are unstable."""

    def __init__(self) -> None:
        tooltips = [("growth rate", "@growth{0.00000000}"), ("frequency", "@frequency{0.00000000}")]
        axes = ("growth rate (1/tau2)", (-1, 1)), ("frequency (rad/tau2)", (-1, 1))
        figure = card.new_figure(*axes, tooltips=tooltips)
        self.source = card.empty_source(("growth", "frequency", "colour"), "spectrum_source")
        figure.add_layout(card.vertical_line(card.NEUTRAL_COLOUR, "dashed"))
        figure.scatter("growth", "frequency", size=11, color="colour", source=self.source)
        self.card = card.Card("spectrum", figure)

    def show(self, answer: dict[str, Any]) -> None:
        """Draws the eigenvalues of `answer`, an answer of the task `spectrum`; if no eigenvalue is known,
        shows the meaning of the status instead."""
        own_names = ("growth_rate", "frequency")
        names = [
            SI_VARIABLE_BY_DIMENSIONLESS_NAME[name]
            if SI_VARIABLE_BY_DIMENSIONLESS_NAME[name] in answer
            else name
            for name in own_names
        ]
        growth, frequency = (answer[name] for name in names)
        is_finite = np.isfinite(growth)
        if not is_finite.any():
            self.card.show_sentence_instead(card.status_sentence(answer))
            return
        growth = growth[is_finite]
        frequency = frequency[is_finite]
        colours = np.where(growth > 0, card.UNSTABLE_COLOUR, card.STABLE_COLOUR)
        self.source.data = card.source_columns(growth=growth, frequency=frequency, colour=colours)
        growth_unit, frequency_unit = (answer["units"][name] for name in names)
        labels = f"growth rate ({growth_unit})", f"frequency ({frequency_unit})"
        limits = card.axis_limits(np.append(growth, 0.0)), card.axis_limits(frequency)
        self.card.set_axes(*limits, labels)
        self.card.set_title(unstable_count_sentence(answer))
        self.card.show_figure()


def unstable_count_sentence(answer: dict[str, Any]) -> str:
    """Sentence that states the number of unstable modes of the answer `answer`, and whether this number is
    certified; the meaning of the status if the number is unknown."""
    unstable_count = int(answer["unstable_count"])
    if unstable_count < 0:
        return answer["sentence"]
    modes_text = {0: "No unstable mode", 1: "1 unstable mode"}.get(
        unstable_count, f"{unstable_count} unstable modes"
    )
    return f"{modes_text}, {'certified' if answer['certified'] else 'not certified'}"


class ModePicture:
    """Real and imaginary part of the deflection Y(u) of the leading mode."""

    def __init__(self) -> None:
        figure = card.new_figure(("u along the arm", (0, 1)), ("deflection Y, Y(1) = 1", (-1, 1)))
        self.source = card.empty_source(("u", "real", "imaginary"), "mode_source")
        for name, colour, dash in (
            ("real", card.STABLE_COLOUR, "solid"),
            ("imaginary", card.UNSTABLE_COLOUR, "dashed"),
        ):
            look = {"line_width": 2.5, "color": colour, "line_dash": dash}
            figure.line("u", name, **look, legend_label=f"{name} part", source=self.source)
        figure.legend.location = "top_left"
        self.card = card.Card("mode", figure)

    def show(self, answer: dict[str, Any]) -> None:
        """Draws the leading mode of `answer`, an answer of the task `spectrum`; if the mode is not known,
        shows the meaning of the status instead."""
        real_part = answer["Y_real"][0]
        imaginary = answer["Y_imag"][0]
        if not np.isfinite(real_part).all():
            self.card.show_sentence_instead(card.status_sentence(answer))
            return
        self.source.data = card.source_columns(u=answer["u"], real=real_part, imaginary=imaginary)
        self.card.set_axes((0.0, 1.0), card.axis_limits(np.append(real_part, imaginary)))
        self.card.show_figure()
