"""How far what ought to stay constant has drifted."""

from harness.measure.metric import Metric

METRICS = (
    Metric("energy_drift", "1", "error", "largest |E - E0| / E0 of the translational energy"),
    Metric("momentum_drift", "1", "error", "largest change of total momentum by pair hits, of the initial sum of m|v|"),
)
