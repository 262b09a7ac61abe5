"""Whole runs of the command timed: scaling, overhead, memory."""
