"""Points of arms without a rod or with equal rods, and the validity of the model."""
