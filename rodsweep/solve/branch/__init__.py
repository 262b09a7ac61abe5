"""Branches of cycles: followed through folds, stable or not, with the points at which they change."""
