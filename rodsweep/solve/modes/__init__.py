"""Leading modes and adjoint modes of one straight rod, and transient growth due to non-normality."""
