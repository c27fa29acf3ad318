"""What a run reports: every metric by name, with its unit and meaning.

Each file of this package declares one metric, or a small family, as `METRICS`; a new file is a new metric. The table is
the single source of names: runs may report nothing else, `harness list` prints it, and expectations and claims are
checked against it. Metrics stand in the order of their kinds, of the names of their files, and of their place there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from harness.measure.metric import KINDS, Metric, Outcome
from harness.modules import modules_in

if TYPE_CHECKING:
    from harness.scene.scene import Scene


def _declared() -> dict[str, Metric]:
    found: dict[str, Metric] = {}
    where: dict[str, str] = {}
    for module in modules_in(__name__):
        for metric in module.METRICS:
            if metric.name in found:
                raise ValueError(f'{module.__name__} declares the metric "{metric.name}", as {where[metric.name]} does')
            found[metric.name], where[metric.name] = metric, module.__name__
    return dict(sorted(found.items(), key=lambda entry: KINDS.index(entry[1].kind)))


METRICS = _declared()

# Made only where an experiment names them.
ON_DEMAND = frozenset(name for name, metric in METRICS.items() if metric.on_demand)

# Parameters that follow from a scene and its mesh; usable wherever a swept leaf is.
DERIVED: dict[str, str] = {
    "faces": "faces of the mesh",
    "hull_vertices": "vertices of the mesh's convex hull",
    "packing": "volume of all bounding spheres / volume of the box",
    "box_side": "m, cube root of the box volume",
}


def from_outcome(scene: Scene, outcome: Outcome) -> dict[str, float]:
    """The metrics that say themselves how they are measured, of those that have a meaning here.

    Parameters
    ----------
    scene : Scene, at the start of the run
    outcome : what the run came to. Its trace is None where nobody has asked for its hits

    Raises
    ------
    RuntimeError
        The function of a metric has failed, which is named.
    """
    made: dict[str, float] = {}
    for name, metric in METRICS.items():
        if metric.measure is None:
            continue
        try:
            value = metric.measure(scene, outcome)
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
            raise RuntimeError(f"the metric {name} cannot be measured: {type(error).__name__}: {error}") from error
        if value is not None:
            made[name] = value
    return made
