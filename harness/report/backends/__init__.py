"""Backends compared on the same poses: who is right, proven, and what being right costs."""
