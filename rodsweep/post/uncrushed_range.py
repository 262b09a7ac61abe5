"""Range of the followed parameter of branches in which the force does not crush the rod."""

from ..model.parameters import CRUSHING_PARAMETERS
from ..results.file.view import View
from ..results.layouts.rods import has_standard_rods
from .branch_curves import ParameterRange, branch_ends, followed_parameter


def uncrushed_range(view: View, rod: int) -> ParameterRange:
    """(start, stop) of the followed range without forces above k1, which crush a uniform rod of linear
    material; stop <= start if all forces of the range crush the rod. For other rods, the whole range. rod:
    index among the points of the file.
    """
    low, high = branch_ends(view)
    if not has_standard_rods(view.config):
        return low, high
    force, stiffness = CRUSHING_PARAMETERS
    columns = {name: float(values[rod]) for name, values in view.point_columns.items()}
    along = followed_parameter(view)
    if along == force:
        return low, min(high, columns[stiffness])
    return (max(low, columns[force]) if along == stiffness else low), high
