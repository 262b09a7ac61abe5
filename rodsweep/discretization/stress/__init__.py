"""The nonlinear rod on a mesh with its stresses as unknowns: balance, rates, Jacobian, and motion of the
tip."""
