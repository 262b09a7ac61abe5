"""The layout of a figure: texts that fit beside each other, and ticks."""
