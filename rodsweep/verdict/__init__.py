"""Verdict on an arm, in sentences: whether the arm flutters, at which load, and whether the model applies.
All thresholds are solved for a range of drag coefficients."""
