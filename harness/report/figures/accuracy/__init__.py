"""Figures of the page of errors against run time."""
