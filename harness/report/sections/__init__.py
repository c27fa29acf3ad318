"""The sections of pages, a file each: a new file is a new section. See `harness.report.section`."""
