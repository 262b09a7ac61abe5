"""Layout of a figure: texts that do not overlap, and tick labels."""
