"""Minimally augmented systems: cycles and their test functions by the factors of a nearby matrix."""
