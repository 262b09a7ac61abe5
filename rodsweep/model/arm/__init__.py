"""The soft arm in SI units: quantities, cross-section, drag, and effects that the model neglects."""
