"""What a run reports: every metric by name, with its unit and meaning.

The table is the single source of names: runs may report nothing else, `harness list` prints it, and expectations and
claims are checked against it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal["counter", "clock", "error", "resource"]


@dataclass(frozen=True)
class Metric:
    """One metric: its unit ("1" for a plain number), its kind and what it means.

    Counters are exact and the same on every machine; clocks are noisy and need statistics; errors, and what else is
    measured of the motion, are deterministic.
    """

    name: str
    unit: str
    kind: Kind
    description: str

    @property
    def noisy(self) -> bool:
        """Whether two repeats of the same run may differ."""
        return self.kind in ("clock", "resource")


def _table(*metrics: Metric) -> dict[str, Metric]:
    return {metric.name: metric for metric in metrics}


def _clock(name: str, meaning: str, unit: str = "s") -> tuple[Metric, Metric]:
    return (
        Metric(name, unit, "clock", f"CPU time: {meaning}"),
        Metric(f"{name}_elapsed", unit, "clock", f"elapsed time: {meaning}"),
    )


METRICS: dict[str, Metric] = _table(
    Metric("frames", "1", "counter", "frames stepped: round(duration / dt)"),
    Metric("pair_tests", "1", "counter", "pairs of bodies put to any test beyond bookkeeping"),
    Metric("narrow_tests", "1", "counter", "pairs of bodies put to the exact shape"),
    Metric("hull_tests", "1", "counter", "pairs of meshes whose hulls were put to a separating axis"),
    Metric("hull_searches", "1", "counter", "pairs of hulls that the last frame's separating axis did not settle"),
    Metric("fcl_tests", "1", "counter", "pairs put to FCL, where kernels settle the others"),
    Metric("contained_pairs", "1", "counter", "pairs of which one mesh was wholly inside the other, which is no hit"),
    Metric("box_tests", "1", "counter", "tests of a body against one of the six walls"),
    Metric("pair_hits", "1", "counter", "touching pairs that were approaching, and so were answered"),
    Metric("pair_contacts", "1", "counter", "touching pairs that were already separating, and so were left alone"),
    Metric("box_hits", "1", "counter", "wall contacts that were approaching, and so were answered"),
    Metric("predictions", "1", "counter", "searches for a body's next event"),
    Metric("events", "1", "counter", "answered hits of pairs and walls"),
    Metric(
        "stale_events", "1", "counter", "predicted events whose partner had changed course, and so were predicted anew"
    ),
    Metric("cell_crossings", "1", "counter", "passages of a body from cell to cell"),
    Metric("list_renewals", "1", "counter", "neighbour lists made anew"),
    Metric(
        "guarded_hits", "1", "counter", "inelastic hits answered elastically, because they came too soon after another"
    ),
    Metric("stalled_events", "1", "counter", "times a body was made to wait, because too many events came in no time"),
    Metric("advancement_steps", "1", "counter", "steps of conservative advancement in all searches for a contact"),
    Metric("predictions_per_event", "1", "counter", "predictions / events"),
    Metric("pair_tests_per_event", "1", "counter", "pair_tests / events, of a predictive run"),
    Metric("pair_tests_per_body", "1", "counter", "pair_tests / (frames · bodies), of a stepped run"),
    Metric(
        "cells_per_body", "1", "counter", "mean number of grid cells that a body's bounding cube overlaps, last frame"
    ),
    Metric(
        "cells_per_body_most", "1", "counter", "largest number of grid cells that a body's cube overlaps, last frame"
    ),
    *_clock("pair_seconds", "finding the touching pairs, pose updates included"),
    *_clock("box_seconds", "testing the box walls"),
    *_clock("response_seconds", "answering hits"),
    *_clock(
        "run_seconds", "the whole motion loop, without imports, compilation, placement, mesh building and recording"
    ),
    *_clock("setup_seconds", "before the motion loop: placement, mesh building, loading the backend"),
    *_clock("pair_seconds_per_frame", "pair_seconds / frames"),
    *_clock("box_seconds_per_frame", "box_seconds / frames"),
    *_clock("frames_per_second", "frames / run_seconds", "1/s"),
    *_clock("simulated_per_second", "simulated seconds / run_seconds", "s/s"),
    Metric("collision_rate", "1/s", "error", "pair hits of a body in a second"),
    Metric("pressure", "Pa", "error", "mean force on the walls over the area that centres can reach"),
    Metric("virial_residual", "1", "error", "imbalance of the virial theorem over the run, relative"),
    Metric("pressure_to_theory", "1", "error", "pressure / that of kinetic theory for a box with walls"),
    Metric("pair_impulse_to_theory", "1", "error", "mean impulse of a pair hit / that of kinetic theory"),
    Metric("energy_drift", "1", "error", "largest |E - E0| / E0 of the translational energy"),
    Metric("momentum_drift", "1", "error", "largest change of total momentum by pair hits, of the initial sum of m|v|"),
    Metric("max_penetration", "1", "error", "deepest overlap of a touching pair seen in a frame, of its mean size"),
    Metric("escaped", "1", "error", "bodies whose centre was seen outside the box"),
    Metric("missed_hits", "1", "error", "hits of the reference that were not reported, of the reference's hits"),
    Metric("extra_hits", "1", "error", "hits reported that the reference does not have, of the reference's hits"),
    Metric("time_error", "s", "error", "median absolute time error of matched hits"),
    Metric("time_error_95", "s", "error", "95th percentile of the absolute time errors of matched hits"),
    Metric("position_error", "m", "error", "largest distance from the reference before the first divergence"),
    Metric("reversal_error", "1", "error", "largest distance from the start after flying there and back, of the size"),
    Metric(
        "relabelling_error", "1", "error", "largest change of a final place when bodies are renumbered, of the size"
    ),
    Metric("mirror_error", "1", "error", "largest change of a final place when the scene is mirrored, of the size"),
    Metric(
        "scaling_error", "1", "error", "largest change of a final place in other units of length and time, of the size"
    ),
    Metric("quaternion_drift", "rad", "error", "largest angle of a final orientation to exp(spin · time) of its start"),
    Metric("rejected", "1", "error", "1 where a run was refused with a reason, 0 where not; for `expect` alone"),
    Metric("divergence_time", "s", "error", "first hit that the reference does not share; the duration without one"),
    Metric(
        "reference_divergence_time",
        "s",
        "error",
        "first hit that the reference does not share with itself in other units",
    ),
    Metric(
        "reference_position_error",
        "m",
        "error",
        "largest distance of the reference from itself in other units, as long",
    ),
    Metric("reference_hits", "1", "error", "hits of the reference while the method watched"),
    Metric("reference_error", "s", "error", "largest error found in a checked sample of the reference's hit times"),
    Metric(
        "missed_hits_expected", "1", "error", "mean over the reference's hits of max(0, 1 - length of contact / dt)"
    ),
    Metric("missed_hits_deviation", "1", "error", "missed hits beyond the expected ones, in standard deviations"),
    Metric("peak_memory", "B", "resource", "largest resident memory of the run's process"),
)

# Made only where an experiment names them, for each takes a flight of its own.
ON_DEMAND = frozenset({"reversal_error", "relabelling_error", "mirror_error", "scaling_error", "quaternion_drift"})

# Parameters that follow from a scene and its mesh; usable wherever a swept leaf is.
DERIVED: dict[str, str] = {
    "faces": "faces of the mesh",
    "hull_vertices": "vertices of the mesh's convex hull",
    "packing": "volume of all bounding spheres / volume of the box",
    "box_side": "m, cube root of the box volume",
}
