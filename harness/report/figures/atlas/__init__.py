"""Figures of the page of the atlas."""
