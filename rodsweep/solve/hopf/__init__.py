"""What is born at a Hopf point: the normal form of the nonlinear rod, from the straight rod alone."""
