"""What a user declares: an experiment in YAML, read with the place of every value, checked, unfolded into points."""

FOLDER = "experiments"
"""Where experiments lie unless somebody names another folder."""
