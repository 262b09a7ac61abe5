"""The leading eigenvalues of one rod: found on a mesh, refined on D, counted."""
