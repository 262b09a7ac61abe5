"""Normal forms of Hopf points: amplitude, frequency and stability of the cycles that bifurcate there."""
