"""The nonlinear rod on a mesh with stresses as unknowns: balance, rates, Jacobian, and motion of the tip."""
