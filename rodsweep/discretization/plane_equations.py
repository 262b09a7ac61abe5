"""Compiled equations of the planar rod: the functions of `stress`, specialised to the Lie algebra se(2)."""

from ..model.lie_algebra import SE2
from .stress import balance as stress_balance
from .stress import jacobian as stress_jacobian

write_balance = stress_balance.write_velocities_and_rates.compiled_for(SE2)
write_balance_parameter_derivative = stress_balance.write_balance_parameter_derivative.compiled_for(SE2)
write_velocity_residuals = stress_balance.write_velocity_residuals.compiled_for(SE2)
write_jacobian = stress_jacobian.write_jacobian.compiled_for(SE2)
