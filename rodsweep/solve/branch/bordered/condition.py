"""Newton's method for a cycle together with a parameter; a condition on the branch closes the system.

The parameter does not distinguish cycles beside a fold. The condition prescribes a linear combination of the
three numbers of `scale`.
"""

from dataclasses import dataclass, replace

import numpy as np

from ....arrays import Array
from ....watch import report
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.newton import ORBIT_NEWTON, ConvergedOrbit, relative_change
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh
from ...point import Unsolvable
from .matrix import BorderedMatrix
from .scale import Scale


@dataclass(frozen=True, eq=False)
class BorderCondition:
    """Equation that closes the bordered system: the component of `Scale.place` along a border, (3,), has a
    prescribed value.
    """

    scale: Scale
    border: Array
    value: float

    @classmethod
    def at(cls, scale: Scale, border: Array, orbit: Orbit, length: float = 0.0) -> "BorderCondition":
        """The condition that the component along `border`, (3,), is larger by `length` than for an orbit."""
        return cls(scale, border, float(border @ scale.place(orbit)) + length)

    def residual(self, orbit: Orbit) -> float:
        """Prescribed value of the component along the border, minus its value at an orbit."""
        return self.value - float(self.border @ self.scale.place(orbit))

    def solved(
        self, orbit: Orbit, tolerance: float, workspace: NewtonWorkspace, distance: float = np.inf
    ) -> ConvergedOrbit:
        """The cycle near an orbit; raises Unsolvable.

        tolerance: relative error of the orbit. workspace: memory of the matrices. distance: largest relative
        distance of the matrix from the cycle, an error of its multipliers and tangent.
        """
        matrix = BorderedMatrix(orbit, self.scale, workspace)
        off = 0.0
        last = np.inf
        step = matrix.step(self.border, self.residual(orbit))
        for _ in range(ORBIT_NEWTON.max_iterations):
            report()
            change = max(relative_change(orbit, step[:-1]), abs(step[-1]) / self.scale.coordinate)
            if not change <= ORBIT_NEWTON.longest_step:
                raise Unsolvable("Newton's method finds no cycle of the branch near its starting point")
            orbit = moved(orbit, self.scale.name, step)
            off = off + change
            rate = change / last if off > change else np.inf  # known from the second step with one matrix on
            # The next step would be smaller by the contraction; it is predicted instead of made.
            settled = change * min(rate, 1.0) <= tolerance and rate <= ORBIT_NEWTON.new_matrix_ratio
            if (settled or change <= tolerance) and off <= distance:
                return ConvergedOrbit(orbit, matrix, off)
            if settled or change <= tolerance or (off > change and rate > ORBIT_NEWTON.new_matrix_ratio):
                matrix = BorderedMatrix(orbit, self.scale, workspace)
                off = 0.0
                step = matrix.step(self.border, self.residual(orbit))
                last = np.inf
            else:
                step = matrix.correction(orbit, self.border, self.residual(orbit))
                last = change
        raise Unsolvable(f"Newton's method on the branch does not converge; its last step is {change:.0e}")

    def on(
        self, mesh: OrbitMesh, found: ConvergedOrbit, tolerance: float, distance: float = np.inf
    ) -> ConvergedOrbit:
        """A known cycle solved on another mesh; raises Unsolvable. Other arguments as in `solved`."""
        return self.solved(mesh.carry(found.orbit), tolerance, found.workspace, distance)


def moved(orbit: Orbit, name: str, change: Array) -> Orbit:
    """An orbit after a change of its values and the parameter's coordinate, (N + 1,); raises Unsolvable."""
    try:
        form = orbit.form.with_coordinate(name, orbit.form.rod.coordinate(name) + float(change[-1]))
    except (ValueError, ZeroDivisionError) as error:
        raise Unsolvable(f"the branch leaves the allowed range of the parameters: {error}") from error
    result = replace(orbit, form=form, values=orbit.values + change[:-1])
    # Where gamma3 passes the least eliminated drag, states have other unknowns and cannot be compared.
    if form.omega_unknown != orbit.form.omega_unknown:
        raise Unsolvable(
            f"at gamma3 = {form.rod.gamma3:.3g} Omega becomes an unknown or is eliminated, and cycles cannot "
            "be followed across"
        )
    if not result.period > 0:
        raise Unsolvable("Newton's method lost the cycle: its period is not positive")
    return result
