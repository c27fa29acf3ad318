"""The overview: a card for every experiment, the cases of stability folded away, and what became of the claims."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby

from markupsafe import Markup

from harness.report.experiment import ExperimentPage
from harness.report.figure import Figure
from harness.report.map.cells import MethodMap, maps_of
from harness.report.map.figure import map_figure
from harness.report.missing import is_judged
from harness.report.quantity import plural
from harness.report.results import Results
from harness.report.stability.case import is_case
from harness.report.weight import weight
from harness.report.words import VERDICTS, verdict_text
from harness.store.records import VerdictRow

_MOST_FINDINGS = 5


@dataclass(frozen=True, eq=False)
class Card:
    """An experiment as the overview lists it, with its first figure in small."""

    page: ExperimentPage
    figure: Figure | None

    @property
    def axis(self) -> str:
        """What the small figure shows: of several panels, the first."""
        panel = next(iter(self.page.arrangement.panels), "")
        return ", ".join(part for part in (self.figure.title if self.figure else "", panel) if part)

    @property
    def badges(self) -> list[tuple[str, str]]:
        """(text, class) of what to know at a glance."""
        noise = self.page.arrangement.noise
        found: list[tuple[str, str]] = [(noise, noise.replace(" ", "-"))] if noise else []
        if self.page.failed:
            found.append((f"{self.page.failed} failed", "failed"))
        for verdict in VERDICTS:
            count = sum(row.verdict == verdict for row in self.page.record.claims if is_judged(row))
            if count:
                found.append((f"{plural(count, 'claim')} {verdict_text(verdict, count)}", verdict))
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
    """All that sections of the overview stand on: the results, with a card an experiment."""

    results: Results

    @cached_property
    def cards(self) -> list[Card]:
        """Folder by folder, those that stand alone first; none of the cases of stability, which have a matrix."""
        found = []
        for place, page in enumerate(self.results.pages):
            if not is_case(page):
                figure = next(iter(page.figures.get("figures", ())), None)
                # ids are unique on a page, and the overview shows figures of many
                found.append(Card(page, replace(figure, name=f"card{place}") if figure else None))
        return sorted(found, key=lambda card: card.group)

    @cached_property
    def maps(self) -> list[MethodMap]:
        """Of who is fastest where: the coarsest first, of each accuracy spheres, convex and concave bodies."""
        shapes = {shape: place for place, shape in enumerate(("sphere", "hull", "mesh"))}
        found = maps_of(self.results.pages)
        return sorted(found, key=lambda made: (made.query, -made.accuracy, shapes.get(made.shape, len(shapes))))

    @cached_property
    def map_figure(self) -> Figure | None:
        """All of them in a figure, which can be had as a file."""
        return replace(map_figure(self.maps), file="map.svg") if self.maps else None

    @cached_property
    def weightiest(self) -> list[Card]:
        """The experiments whose findings weigh most, five at most; those that are only maps are shown as maps."""
        shown = {made.page.record.name for made in self.maps}
        found = [card for card in self.cards if card.page.findings.sentences and card.page.record.name not in shown]
        return sorted(found, key=lambda card: weight(card.page), reverse=True)[:_MOST_FINDINGS]

    @property
    def further(self) -> int:
        """How many experiments have found something else."""
        return sum(bool(card.page.findings.sentences) for card in self.cards) - len(self.weightiest)

    @property
    def groups(self) -> list[tuple[str, list[Card]]]:
        """The cards of each folder, with its name."""
        return [(group, list(cards)) for group, cards in groupby(self.cards, key=lambda card: card.group)]

    @property
    def cases(self) -> list[ExperimentPage]:
        """The pages of the cases of stability."""
        return [page for page in self.results.pages if is_case(page)]

    @property
    def failures(self) -> list[tuple[ExperimentPage, Markup]]:
        """What is broken or failed, of the cases too."""
        return [(page, sentence) for page in self.results.pages for sentence in page.findings.failures]

    @cached_property
    def claims(self) -> list[tuple[ExperimentPage, VerdictRow]]:
        """Every claim, with the experiment that makes it; those of cases say how far a method falls short there."""
        return [(card.page, row) for card in self.cards for row in card.page.record.claims if is_judged(row)]

    @property
    def totals(self) -> str:
        """How much was measured, and what became of the claims, in two sentences."""
        pages = self.results.pages
        runs, failed = sum(len(page.runs) for page in pages), sum(page.failed for page in pages)
        text = f"{plural(len(pages), 'experiment')}, {plural(runs, 'run')}, {failed or 'none'} failed."
        verdicts = Counter(row.verdict for _, row in self.claims)
        ways = (("holds", "hold"), ("fails", "do not"), ("undecided", "undecided"))
        listed = ", ".join(f"{verdicts[verdict]} {word}" for verdict, word in ways if verdicts[verdict])
        return f"{text} Of {plural(len(self.claims), 'claim')}, {listed}." if listed else text
