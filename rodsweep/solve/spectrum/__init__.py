"""Leading eigenvalues of one rod: solved on a mesh, refined by Newton's method on D, and counted."""
