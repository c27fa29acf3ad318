"""Metrics, clocks, statistics, theory and verdicts."""
