"""What all figures share: symbols, labels, colours, and how an axis is scaled."""

import numpy as np

SYMBOLS = {"F": r"\tilde F", "k1": r"\tilde k_1", "k2": r"\tilde k_2", "gamma3": r"\tilde\gamma_3"}
FORCE, DRAG = r"[$k_3/L^2$]", r"\gamma_2 L^2"
LABELS = {
    "F": rf"follower force ${SYMBOLS['F']}$  {FORCE}",
    "k1": rf"stretch stiffness ${SYMBOLS['k1']}$  {FORCE}",
    "k2": rf"shear stiffness ${SYMBOLS['k2']}$  {FORCE}",
    "gamma3": rf"rotational drag ${SYMBOLS['gamma3']}$  [${DRAG}$]",
}
INVERSE_DRAG = rf"inverse rotational drag $1/{SYMBOLS['gamma3']}$  [$1/({DRAG})$]"
FIRST, SECOND, THIRD = "#0072B2", "#D55E00", "#009E73"
"""Blue, vermilion and green of Okabe and Ito: told apart by the colour-blind."""
STYLE = {"font.size": 10, "axes.grid": False, "axes.spines.top": False, "axes.spines.right": False}


def plain(text: object) -> str:
    """A user's text, in which a dollar is a dollar and not mathematics."""
    return str(text).replace("$", r"\$")


def is_logarithmic(values: np.ndarray) -> bool:
    """Whether an axis was spaced in equal ratios."""
    if len(values) < 3 or values[0] <= 0 or not np.isfinite(values).all():
        return False
    ratio = values[1:] / values[:-1]
    return bool(np.ptp(ratio) < 1e-6 * ratio[0] and np.ptp(np.diff(values)) > 1e-6 * values[-1])
