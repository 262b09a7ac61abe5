"""Special points of branches: kinds, location, and curves over two parameters.

In a parameter plane, a row is a line along which one parameter varies; the second parameter, the rows'
parameter, has a fixed value on each row.
"""
