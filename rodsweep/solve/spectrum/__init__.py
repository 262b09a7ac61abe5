"""Leading eigenvalues of one rod: solved on a mesh, refined on D, counted."""
