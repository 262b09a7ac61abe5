"""First lines about the result of one rod: the answer, and the numbers and the list behind it."""
