"""Leading modes and adjoint modes of one rod, and transient growth due to non-normality."""
