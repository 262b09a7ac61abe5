"""Combination of result files: merging, joining, extension, and comparison of the configs of two files."""
