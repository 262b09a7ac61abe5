"""Elements in space and intervals in time: nodes, basis, quadrature, meshes, and their order and number."""
