"""Summaries, tables, figures and reports from result files. Only this package imports matplotlib. The package
contains no solver."""
