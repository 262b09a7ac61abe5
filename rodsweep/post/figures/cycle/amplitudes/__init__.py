"""Amplitudes of limit cycles over a parameter, with Hopf points and fitted square-root laws."""
