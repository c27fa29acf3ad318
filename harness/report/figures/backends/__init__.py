"""Figures of the page of backends."""
