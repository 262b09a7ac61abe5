"""Summaries, tables, figures and reports from result files. Only this package imports matplotlib. It contains
no solver.
"""
