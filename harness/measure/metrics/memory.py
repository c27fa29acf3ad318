"""What a run took of the machine's memory."""

from harness.measure.metric import Metric

METRICS = (Metric("peak_memory", "B", "cost", "largest resident memory of the run's process", noisy=True),)
