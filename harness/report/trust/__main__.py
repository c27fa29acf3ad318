"""Simulate the rates anew, and keep them."""

from harness.report.trust.rates import store

store()
