"""What a user declares: an experiment in YAML, read with the place of every value, checked, unfolded into points."""
