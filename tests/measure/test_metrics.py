"""Metrics that say how they are measured: what one of them cannot be measured from names it."""

from types import SimpleNamespace

import pytest

from harness.measure import metrics
from harness.measure.metric import Metric


def test_a_metric_whose_function_fails_is_named(monkeypatch):
    failing = Metric("share", "1", "count", "of hits", measure=lambda scene, outcome: 1 / outcome.metrics["hits"])
    monkeypatch.setattr(metrics, "METRICS", {"share": failing})
    with pytest.raises(RuntimeError, match="the metric share cannot be measured: KeyError: 'hits'"):
        metrics.from_outcome(None, SimpleNamespace(metrics={}, trace=None))
    assert metrics.from_outcome(None, SimpleNamespace(metrics={"hits": 4}, trace=None)) == {"share": 0.25}
