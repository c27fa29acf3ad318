"""How far a frame is from what the machine's memory allows."""

from functools import partial

from harness.measure.metric import Metric

_on_demand = partial(Metric, noisy=True, tabulated=False, on_demand=True)

METRICS = (
    _on_demand("copy_bandwidth", "B/s", "cost", "read and written by a plain copy after the run", better="neither"),
    Metric(
        "frame_bytes_per_body", "B", "cost",
        "traffic of memory that a frame which places every body cannot do without", "bytes a body and frame",
        better="neither", tabulated=False, on_demand=True,
    ),
    _on_demand(
        "times_of_memory", "1", "cost",
        "run_seconds / frames, over the time of frame_bytes_per_body of all bodies at copy_bandwidth",
        "times of memory",
    ),
)  # fmt: skip
