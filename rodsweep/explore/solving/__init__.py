"""Requests of the page, and the processes that solve them. Independent of controls and pictures."""
