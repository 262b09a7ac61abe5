"""First cycles of branches: near a Hopf point, by its normal form, and near a symmetry breaking."""
