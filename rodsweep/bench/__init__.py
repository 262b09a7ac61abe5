"""Speed against error: this tool beside what its users would otherwise write, timed in one run.

The only importer of SciPy, which is an optional extra (`bench`).
"""
