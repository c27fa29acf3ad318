"""Backends on the same poses: verdicts, judged in exact arithmetic and minimised."""
