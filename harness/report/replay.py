"""The replay of an experiment: what its page shows of it, and the file that plays it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from harness.replay.facts import facts
from harness.replay.kept_still import HEIGHT, WIDTH
from harness.replay.page import described, replay_page, still_text, summary
from harness.report.quantity import quantity
from harness.report.words import leaf_label
from harness.store.recording import recording_of
from harness.store.records import ExperimentRecord


@dataclass(frozen=True)
class Replay:
    """One recorded scene.

    Parameters
    ----------
    page : the file that plays it
    still : a PNG of its first moment, base64
    alt, caption : the picture in words, and what is to be seen
    """

    page: str
    still: str
    alt: str
    caption: str
    file: str = "replay.html"
    width: int = WIDTH
    height: int = HEIGHT

    @property
    def size(self) -> str:
        """Of the file."""
        return quantity(float(len(self.page.encode())), "B")


def replay_of(database: str | Path, record: ExperimentRecord) -> Replay | None:
    """The replay of an experiment; None where nothing was recorded."""
    found = recording_of(database, record.name)
    if found is None:
        return None
    swept = [leaf_label(leaf, found.parameters.get(leaf)) for leaf in record.specification.get("swept") or ()]
    still = still_text(found.recording)
    page = replay_page(
        found.recording, record.title, facts(found.parameters, found.counters), back="index.html#replay", picture=still
    )
    which = f"{', '.join(swept)}: " if swept else ""
    return Replay(page, still, described(found.recording), f"{which}{summary(found.recording)}.")
