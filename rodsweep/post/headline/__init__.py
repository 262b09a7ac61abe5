"""First lines printed about the result of one rod: a sentence with the answer, then numbers and a list."""
