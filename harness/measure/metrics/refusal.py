"""Whether a run was refused."""

from harness.measure.metric import Metric

METRICS = (
    Metric(
        "rejected", "1", "error", "1 where a run was refused with a reason, 0 where not; for `expect` alone",
        tabulated=False,
    ),
)  # fmt: skip
