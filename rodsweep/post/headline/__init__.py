"""First lines printed about the result of one rod: a sentence with the answer, the numbers, and the list
behind it.
"""
