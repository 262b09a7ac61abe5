"""Leading modes and adjoint modes of one straight rod, with their condition numbers, and the numerical
abscissa and transient growth due to non-normality."""
