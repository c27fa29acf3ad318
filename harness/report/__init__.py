"""The report: a results file turned into pages of findings, tables and figures."""
