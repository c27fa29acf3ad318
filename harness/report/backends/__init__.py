"""Backends held against each other: who is right, proven, and what being right costs."""
