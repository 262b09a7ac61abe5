"""The job of a config and the plan of its result file; reasons of failures, unforeseen exceptions, and
solution in memory."""
