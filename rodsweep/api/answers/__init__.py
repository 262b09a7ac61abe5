"""Answers of the Python interface: attributes, tables, pictures and printed text."""
