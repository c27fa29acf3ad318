"""How often the statements of a report are false, by simulation: the same code writes them, on invented times.

`python -m harness.report.trust` makes the rates anew and keeps them as `rates.json` beside it, which the page shows.
"""
