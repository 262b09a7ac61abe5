"""Number of an arm's eigenvalues right of a vertical line, from the winding number of D."""
