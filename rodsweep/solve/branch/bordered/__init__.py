"""Cycles of a branch, solved together with the parameter: units, bordered matrix, closing condition."""
