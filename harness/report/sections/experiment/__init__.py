"""Sections of the page of an experiment."""
