"""Amplitudes of limit cycles against a parameter, with Hopf points and fitted square-root laws."""
