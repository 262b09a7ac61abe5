"""Summaries of arms in SI units."""
