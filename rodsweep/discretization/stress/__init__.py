"""The rod in motion on a mesh, with the stresses as unknowns: balance, rates and Jacobian."""
