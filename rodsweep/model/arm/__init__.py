"""The soft arm in SI units: its quantities, cross-section and drag, and the effects that the model neglects."""
