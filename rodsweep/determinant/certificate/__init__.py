"""Proofs about the spectrum of a uniform rod: a-priori box, counts of eigenvalues, cover of crossings by
boxes."""
