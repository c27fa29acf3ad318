"""Figures of the page of truth sets."""
