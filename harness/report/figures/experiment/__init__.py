"""Figures of the page of an experiment."""
