"""How far the constraints of the motion were violated: bodies do not overlap, and stay in the box."""

from harness.measure.metric import Metric

METRICS = (
    Metric(
        "max_penetration", "1", "error", "deepest overlap of a touching pair seen in a frame, of its mean size",
        "deepest penetration, of body size",
    ),
    Metric("escaped", "1", "error", "bodies whose centre was seen outside the box", exact=True),
)  # fmt: skip
