"""A comparison as JSON, for `--json` and for the database."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import isinf
from typing import Any, TypeAlias

from harness.compare.cross_section import cross_section
from harness.compare.minimise import minimise
from harness.compare.outcome import Case, Comparison, Failure
from harness.compare.question import Question
from harness.compare.reproduction import text_of
from harness.compare.tally import Approximation, Counts, GapHistogram
from harness.vocabulary import NEAR_QUERIES, MethodName

Known: TypeAlias = dict[tuple[str, Question, str, tuple[int, int], bytes], Case]
"""The smaller cases, by who is wrong about which bodies at which pose."""


@dataclass(frozen=True, eq=False)
class Reduced:
    """A case, and the smaller one that was made of it.

    Parameters
    ----------
    small : the smallest scene that shows it; None where no scene of its own shows it
    meshes : names of the files of the meshes
    tried : whether it was tried to make it smaller
    """

    case: Case
    small: Case | None
    meshes: tuple[str, ...]
    tried: bool = True

    @property
    def text(self) -> str | None:
        """The experiment that shows it by itself."""
        return None if self.small is None else text_of(self.small, self.meshes)

    @property
    def name(self) -> str:
        """Of a file for it, without number and suffix."""
        return "-".join(self.case.backends).replace("/", "-")


def reduced(found: Comparison, mesh_name: Mapping[str, str], most: int, known: Known | None = None) -> list[Reduced]:
    """Every wrong verdict, those that both backends share last; the first few of every backend made smaller.

    Parameters
    ----------
    found : Comparison
    mesh_name : the file of a mesh, by its identity
    most : cases of one backend to make smaller: more of them show the same defect again
    known : what was made of them beside other backends, which is added to
    """
    known = {} if known is None else known
    tried: dict[str, int] = {}
    rows = []
    for case in found.cases + found.shared:
        tried[case.wrong] = tried.get(case.wrong, 0) + 1
        # what computes events has no verdict on bodies at rest, so that nothing smaller would show it
        now = tried[case.wrong] <= most and MethodName.read(case.wrong, case.scene.shape).stepped
        small = None
        if now:
            place = (case.wrong, case.question, case.scene.shape, case.bodies, case.pose.positions.tobytes())
            small = minimise(case, known.get(place))
            if small is not None:
                known.setdefault(place, small)
        names = tuple(mesh_name.get(mesh.identity, mesh.name) for mesh in case.scene.meshes)
        rows.append(Reduced(case, small, names, now))
    return rows


def document(found: Comparison, rows: list[Reduced], files: dict[int, str]) -> dict[str, Any]:
    """The document that `harness compare --json` prints.

    Parameters
    ----------
    found : Comparison
    rows : of its cases
    files : the file that a case was written to, by its place
    """
    cases = [case_row(row, files.get(place)) for place, row in enumerate(rows)]
    real = len(found.cases)
    return {
        "pairs": [_counts(tally) for tally in found.tallies],
        "cases": cases[:real] + [failure_row(one) for one in found.failures if one.kind == "crashed"],
        "findings": [failure_row(one) for one in found.failures if one.kind != "crashed"],
        "shared": cases[real:],
        "checked": [_counts(checked) for checked in found.checked],
        "approximations": [_approximation(one) for one in found.approximations],
        "gaps": [_gaps(histogram) for histogram in found.gaps],
        "flights": [asdict(flight) for flight in found.free_runs],
        "unsupported": found.unsupported,
        "left_out": found.left_out,
    }


def case_row(row: Reduced, file: str | None) -> dict[str, Any]:
    """A wrong verdict; `depends_on_order` marks one that a single query of the same pose does not show."""
    case = row.case
    where = {"pose": case.pose.name, "call": case.query_index, "touching": case.judgement.touching}
    return {
        "backends": list(case.backends),
        "wrong": case.wrong,
        "shape": case.scene.shape,
        "bodies": list(case.bodies),
        "gap": case.judgement.gap,
        "certificate": case.judgement.certificate | where,
        "file": file,
        "minimised_to": None if row.small is None else len(row.small.scene.bodies),
        "depends_on_order": row.tried and row.small is None,
        **_asked(case),
    }


def _asked(case: Case) -> dict[str, Any]:
    """What was asked, of queries other than collision; what was told is None of a pair that was not reported."""
    question = case.question
    if question.query == "collision":
        return {}
    within = {"within": question.within} if question.query in NEAR_QUERIES else {"moment": case.moment}
    told = None if case.told is None or isinf(case.told) else case.told
    return {"query": question.query, **within, "tolerance": question.tolerance, "told": told, "error": case.error}


def failure_row(failure: Failure) -> dict[str, Any]:
    """A crash has no bodies; neither it nor a verdict that changes has a gap, or a proof but its reason."""
    where = {"pose": failure.pose, "call": failure.query_index}
    return {
        "backends": list(failure.backends),
        "wrong": failure.backend,
        "bodies": list(failure.bodies),
        "gap": None,
        "certificate": {"kind": failure.kind, **where, "reason": failure.reason},
        "file": None,
    }


def shown_case(row: Reduced) -> dict[str, Any]:
    """A case with all that a page needs to show it: the smaller one's proof, picture and file, where there is one."""
    best = row.small or row.case
    i, j = best.bodies
    sizes = best.scene.bodies.sizes
    small = None if row.small is None else {
        "bodies": list(best.bodies),
        "gap": best.judgement.gap,
        "certificate": best.judgement.certificate | {"touching": best.judgement.touching},
        **_asked(best),
    }  # fmt: skip
    return case_row(row, None) | {
        "sizes": [float(sizes[i]), float(sizes[j])],
        "section": cross_section(best),
        "minimised": small,
        "text": row.text,
        "mesh": ", ".join(row.meshes) or None,
    }


def _counts(counts: Counts) -> dict[str, Any]:
    """The query is named where it is not collision."""
    row = {**asdict(counts), "backends": list(counts.backends)}
    return row if counts.query != "collision" else {key: value for key, value in row.items() if key != "query"}


def _approximation(one: Approximation) -> dict[str, Any]:
    return _counts(one) | {"false_share": one.false_share, "missed_share": one.missed_share}


def _gaps(histogram: GapHistogram) -> dict[str, Any]:
    return _counts(histogram) | {
        "counts": {kind: dict(sorted(decades.items())) for kind, decades in sorted(histogram.counts.items())}
    }
