"""Leading modes of one rod, their adjoints, and the transient growth that non-normality allows."""
