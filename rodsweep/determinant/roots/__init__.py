"""Roots of D, by Newton's method."""
