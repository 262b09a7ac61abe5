"""Normal forms of Hopf points, the criticality of the branches of cycles that start there, and generalised
Hopf points with their curves."""
