"""The pages beside those of experiments, a file each. See `harness.report.page`."""
