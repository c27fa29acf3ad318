"""The figures of the report, a file each: a new file is a new figure. See `harness.report.figure`."""
