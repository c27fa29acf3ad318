"""What happened in the scene: hits, answered and not."""

from harness.measure.metric import Metric, counter

METRICS = (
    counter("events", "answered hits of pairs and walls", kind="physics"),
    counter(
        "pair_hits", "touching pairs that were approaching, and so were answered", "object/object hits", kind="physics"
    ),
    counter(
        "pair_contacts", "touching pairs that were already separating, and so were left alone",
        "object/object contacts left alone", kind="physics",
    ),
    counter(
        "box_hits", "wall contacts that were approaching, and so were answered", "object/wall hits", kind="physics"
    ),
    Metric(
        "event_digest", "1", "physics",
        "number from 1 to 2^52 that stands for all hits of a stepped run, in their order", tabulated=False,
    ),
)  # fmt: skip
