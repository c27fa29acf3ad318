"""How far a run differs from the same motion backwards, with other numbers of bodies, mirrored, or in other units."""

from harness.measure.metric import Metric


def _on_demand(name: str, description: str, unit: str = "1") -> Metric:
    return Metric(name, unit, "error", description, tabulated=False, on_demand=True)


METRICS = (
    _on_demand("reversal_error", "largest distance from the start after flying there and back, of the size"),
    _on_demand("relabelling_error", "largest change of a final place when bodies are renumbered, of the size"),
    _on_demand("mirror_error", "largest change of a final place when the scene is mirrored, of the size"),
    _on_demand("scaling_error", "largest change of a final place in other units of length and time, of the size"),
    _on_demand("quaternion_drift", "largest angle of a final orientation to exp(spin · time) of its start", "rad"),
)
