"""Combination of files: merging, joining and extension, and comparison of the configs of two files."""
