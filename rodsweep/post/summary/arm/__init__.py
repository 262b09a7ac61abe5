"""Summaries of results about arms, in SI units."""
