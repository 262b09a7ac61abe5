"""What the solvers' numbers mean for an arm: thresholds over its range of drag, a verdict in sentences."""
