"""Accuracy of a cycle: the mesh for a requested accuracy, error estimates, and the minimal period."""
