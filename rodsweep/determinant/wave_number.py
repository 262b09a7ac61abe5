"""Wave number of an eigenfunction of a uniform rod or of an arm."""

from ..model.rod import Rod
from .arm.determinant import arm_determinant
from .value import newton_correction_and_scales


def wave_number(rod: Rod, w: complex) -> float:
    """Bound of |q| in the exponentials exp(+-q u) of the eigenfunction at w, in 1/L; for an arm that is not
    uniform or not of linear material, the average along the arm.
    """
    return (
        newton_correction_and_scales(w, rod.coefficients)[2]
        if rod.is_uniform_and_linear
        else arm_determinant(rod).wave_number(w)
    )
