"""Number of an arm's eigenvalues right of a vertical line."""
