"""The overview: every experiment with a card, the cases of stability folded away, and what became of the claims."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby

from markupsafe import Markup

from harness.report.accuracy import AccuracySection
from harness.report.figures import Figure
from harness.report.missing import is_judged
from harness.report.pages import ExperimentPage
from harness.report.quantity import plural
from harness.report.stability import Matrix, is_case
from harness.store.records import VerdictRow


@dataclass(frozen=True, eq=False)
class Listed:
    """An experiment as the overview lists it."""

    page: ExperimentPage
    href: str
    figure: Figure | None

    @property
    def axis(self) -> str:
        """What the small figure shows: of several panels, the first."""
        panel = next(iter(self.page.arrangement.panels), "")
        return ", ".join(part for part in (self.figure.title if self.figure else "", panel) if part)

    @property
    def badges(self) -> list[tuple[str, str]]:
        """(text, class) of what to know at a glance."""
        found = [(self.page.stability, self.page.stability)] if self.page.stability else []
        if self.page.failed:
            found.append((f"{self.page.failed} failed", "failed"))
        for verdict in ("holds", "fails", "undecided"):
            count = sum(row.verdict == verdict for row in self.page.record.claims if is_judged(row))
            if count:
                word = {"holds": "hold", "fails": "fail"}.get(verdict, verdict) if count > 1 else verdict
                found.append((f"{plural(count, 'claim')} {word}", verdict))
        if self.page.findings.warnings:
            found.append((plural(len(self.page.findings.warnings), "warning"), "noisy"))
        return found

    @property
    def group(self) -> str:
        """The folder of experiments it belongs to; "" for one that stands alone."""
        name = self.page.record.name
        return name.rpartition("/")[0].replace("/", ", ").replace("-", " ").capitalize()

    @property
    def size(self) -> str:
        """How much was measured."""
        return f"{plural(len(self.page.record.points), 'point')}, {plural(len(self.page.runs), 'run')}"


@dataclass(frozen=True, eq=False)
class Overview:
    """What the first page says of all experiments together."""

    pages: Sequence[ExperimentPage]
    accuracy: Sequence[AccuracySection]
    stability: Matrix | None

    @cached_property
    def _all(self) -> list[Listed]:
        listed = []
        for place, page in enumerate(self.pages):
            # ids are unique on a page, and the overview shows figures of many
            figure = replace(page.figures[0], name=f"card{place}") if page.figures else None
            listed.append(Listed(page, f"{page.folder}/index.html", figure))
        return listed

    @cached_property
    def cases(self) -> list[Listed]:
        """The experiments of the matrix of stability, which speaks for them."""
        return [entry for entry in self._all if is_case(entry.page)]

    @cached_property
    def listed(self) -> list[Listed]:
        """All others, folder by folder; those that stand alone come first."""
        return sorted((entry for entry in self._all if entry not in self.cases), key=lambda entry: entry.group)

    @property
    def groups(self) -> list[tuple[str, list[Listed]]]:
        """The same, with the name of each folder."""
        return [(group, list(entries)) for group, entries in groupby(self.listed, key=lambda entry: entry.group)]

    @property
    def failures(self) -> list[tuple[Listed, Markup]]:
        """What is broken or failed, of the cases too."""
        return [(entry, sentence) for entry in self._all for sentence in entry.page.findings.failures]

    @cached_property
    def claims(self) -> list[tuple[Listed, VerdictRow]]:
        """Every claim, with the experiment that makes it."""
        return [(entry, row) for entry in self.listed for row in entry.page.record.claims if is_judged(row)]

    @property
    def claims_by_source(self) -> list[tuple[str, list[tuple[Listed, VerdictRow]]]]:
        """Under a heading each: those of the homework, whose numbers these are held against, then all others."""
        homework = [claim for claim in self.claims if str(claim[1].criterion.get("source", "")).startswith("homework")]
        others = [claim for claim in self.claims if claim not in homework]
        return [(title, found) for title, found in (("Of the homework", homework), ("Of our own", others)) if found]

    @property
    def totals(self) -> str:
        """How much was measured, and what became of the claims, in two sentences."""
        runs, failed = sum(len(page.runs) for page in self.pages), sum(page.failed for page in self.pages)
        text = f"{plural(len(self.pages), 'experiment')}, {plural(runs, 'run')}, {failed or 'none'} failed."
        verdicts = Counter(row.verdict for _, row in self.claims)
        ways = (("holds", "hold"), ("fails", "do not"), ("undecided", "undecided"))
        said = ", ".join(f"{verdicts[verdict]} {word}" for verdict, word in ways if verdicts[verdict])
        return f"{text} Of {plural(len(self.claims), 'claim')}, {said}." if said else text
