"""Special points of branches: kinds, location, and curves over two parameters.

In a parameter plane, a row is a line along which one parameter varies; the second parameter, the row
parameter, has a fixed value on each row. The row coordinate is the position of this value on its axis, from 0
to 1.
"""
