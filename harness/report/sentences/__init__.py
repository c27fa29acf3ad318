"""Sentences of the pages, each from the numbers that it tells."""
