"""How long runs will take, from how long they took."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

from harness.runner.schedule import Job

START_UP = 2.5  # s until a warm server is ready; there is one a backend


class Estimate:
    """Elapsed seconds of jobs, learned from earlier runs and from those of this sweep.

    Parameters
    ----------
    known : {key of a point, or its parameters as sorted JSON text: s}
    parameters : {key: leaves and derived parameters}
    """

    def __init__(self, known: Mapping[str, float], parameters: Mapping[str, Mapping[str, Any]]) -> None:
        self._known = dict(known)
        self._texts = {key: json.dumps(dict(found), sort_keys=True) for key, found in parameters.items()}

    def of(self, job: Job) -> float | None:
        """Seconds of a job; None where neither its point nor one with its parameters was ever run."""
        return self._known.get(job.key, self._known.get(self._texts.get(job.key, "")))

    def learn(self, job: Job, seconds: float) -> None:
        """Take in a job that has ended."""
        self._known[job.key] = seconds

    def left(self, jobs: Iterable[Job]) -> float | None:
        """Seconds of all these jobs, one after another; the unknown take as long as the known do on average.

        None where nothing is known, of these or of any other point of their experiments.
        """
        each = [self.of(job) for job in jobs]
        if not each:
            return 0.0
        known = [seconds for seconds in each if seconds is not None]
        known = known or [self._known[key] for key in self._texts if key in self._known]
        return sum(known) / len(known) * len(each) if known else None


def duration_text(seconds: float) -> str:
    """A time as people write it.

    >>> duration_text(40), duration_text(700), duration_text(12000)
    ('40 s', '12 min', '3 h 20 min')
    """
    if seconds < 99.5:
        return f"{seconds:.0f} s" if seconds >= 0.95 else f"{seconds:.1f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60} min"
