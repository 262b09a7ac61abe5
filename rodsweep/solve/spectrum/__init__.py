"""Leading eigenvalues of rods: solved on meshes, refined by Newton's method on the determinant D, counted,
and followed along a path (`path`)."""
