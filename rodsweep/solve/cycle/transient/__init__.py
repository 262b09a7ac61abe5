"""The integrated motion from a start to the neighbourhood of a cycle, to a torus, or to the straight rod."""
