"""Points of arms, and whether the model applies to them."""
