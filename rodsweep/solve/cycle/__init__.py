"""The limit cycle of one rod: from a start to it, solved by Newton's method, refined and measured."""
