"""How wrong the near pairs of a run are: missed, extra, their gaps and their nearest points, against the reference."""

from __future__ import annotations

import numpy as np

from harness.arrays import Ints, Pairs
from harness.motion.answers import NearAnswers
from harness.motion.law import MotionLaw
from harness.motion.recorded_motion import trajectory_of
from harness.reference.body_gaps import off_surface
from harness.reference.near_pairs import NearReference, placed
from harness.scene.scene import Scene

# Pairs whose nearest points are held against the surfaces, at the most.
MOST_WITNESSES = 100


def gap_errors(
    scene: Scene, law: MotionLaw, reference: NearReference, found: NearAnswers, within: float
) -> dict[str, float]:
    """The metrics that near pairs are judged by, in the frames that the reference has looked at.

    Parameters
    ----------
    scene : of the reference's shape
    law : of the run
    reference : NearReference
    found : what the run answered
    within : m

    Returns
    -------
    dict
        `reference_pairs`, `reference_gap_error` (m), `missed_pairs` and `extra_pairs`; of answers with gaps
        `gap_error`, `gap_error_95` and `gap_error_most` (m), and with points `witness_error` (m).
    """
    known = dict(zip(_keys(reference.at, reference.pairs), range(len(reference.at)), strict=True))
    looked = np.isin(found.frames, reference.frames)
    rows = np.flatnonzero(looked)
    answered = dict(zip(_keys(found.frames[rows], found.pairs[rows]), rows.tolist(), strict=True))
    # a pair whose bounds leave open whether it is near may be reported or not
    certain = {key for key, row in known.items() if reference.upper[row] <= within}
    metrics = {
        "reference_pairs": float(len(certain)),
        "reference_gap_error": float((reference.upper - reference.lower).max(initial=0.0)),
        "missed_pairs": len(certain - answered.keys()) / max(1, len(certain)),
        "extra_pairs": len(answered.keys() - known.keys()) / max(1, len(certain)),
    }
    matched = sorted(known.keys() & answered.keys())
    ours, theirs = [answered[key] for key in matched], [known[key] for key in matched]
    if not matched or np.isnan(found.gaps[ours]).any():
        return metrics
    errors = np.abs(found.gaps[ours] - reference.upper[theirs])
    metrics |= {
        "gap_error": float(np.median(errors)),
        "gap_error_95": float(np.quantile(errors, 0.95)),
        "gap_error_most": float(errors.max()),
    }
    witnessed = [(row, known) for row, known in zip(ours, theirs, strict=True) if np.isfinite(found.points[row]).all()]
    if witnessed:
        chosen = np.unique(np.linspace(0, len(witnessed) - 1, MOST_WITNESSES).astype(np.int64))
        metrics["witness_error"] = max(
            _witness_error(scene, law, found, witnessed[k][0], float(reference.upper[witnessed[k][1]])) for k in chosen
        )
    return metrics


def _keys(frames: Ints, pairs: Pairs) -> list[tuple[int, int, int]]:
    return list(zip(frames.tolist(), pairs[:, 0].tolist(), pairs[:, 1].tolist(), strict=True))


def _witness_error(scene: Scene, law: MotionLaw, found: NearAnswers, row: int, gap: float) -> float:
    """By how much the nearest points of a pair are off the bodies, or farther apart than the gap, m."""
    trajectory = trajectory_of(scene, folded=True, turning=True)
    trajectory.move_to(law.time_of(int(found.frames[row])))
    points = found.points[row]
    error = float(np.linalg.norm(points[0] - points[1])) - gap
    for body, point in zip(found.pairs[row].tolist(), points, strict=True):
        arm = (point - trajectory.positions[body])[None]
        if scene.shape == "sphere":
            off = float(np.linalg.norm(arm)) - float(scene.bodies.radii[body])
        else:
            surface = placed(scene, trajectory, body)
            off = float(off_surface(arm, surface, solid=scene.shape == "hull")[0])
        error = max(error, off)
    return max(error, 0.0)
