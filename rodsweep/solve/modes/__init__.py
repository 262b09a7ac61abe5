"""The leading modes of one rod, their adjoints, and the growth that non-normality allows."""
