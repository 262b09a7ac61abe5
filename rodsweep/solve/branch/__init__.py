"""Branches of cycles, stable or not: followed through folds, with the special points on them."""
