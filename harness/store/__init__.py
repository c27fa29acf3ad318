"""The results database: writing it (`database`) and turning it into tables (`tables`)."""

DATABASE = "results/results.db"
"""Where results are kept unless somebody names another file."""
