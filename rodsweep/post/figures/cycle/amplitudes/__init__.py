"""Amplitudes of cycles over a parameter, with Hopf points and square-root laws."""
