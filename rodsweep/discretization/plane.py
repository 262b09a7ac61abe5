"""Compiled equations of the planar rod: the functions of `stress`, specialised to the Lie algebra se(2)."""

from ..model.algebra import SE2
from .stress import balance as stress_balance
from .stress import jacobian as stress_jacobian

balance = stress_balance.balance.compiled_for(SE2)
balance_change = stress_balance.balance_change.compiled_for(SE2)
velocity_balance = stress_balance.velocity_balance.compiled_for(SE2)
jacobian = stress_jacobian.jacobian.compiled_for(SE2)
