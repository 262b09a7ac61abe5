"""Changes of the leading eigenvalues of the straight rod along a parameter, and diagrams in two
parameters."""
