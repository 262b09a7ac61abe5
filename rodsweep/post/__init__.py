"""Summaries and figures from result files. The only importer of matplotlib; knows no solver."""
