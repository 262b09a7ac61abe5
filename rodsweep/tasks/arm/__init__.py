"""Points of an arm: points to which the rod model does not apply, points with equal rods, and the validity of
the model."""
