"""A proof in words and numbers: what the judge found of a case, and how anyone can check it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from harness.report.quantity import as_given, number

_ERRORS = {
    "missed": "missing",
    "false": "false: they are farther apart",
    "too wide": "too wide a gap",
    "too narrow": "too narrow a gap",
    "late": "late",
    "early": "early, if they meet at all",
}
"""In which way an answer is wrong, to follow "The answer is"."""


def sentences_of(row: Mapping[str, Any]) -> list[str]:
    """What is true, who is wrong, the proof, where it was seen, and how small it was made."""
    small = row["minimised"] or row
    i, j = small["bodies"]
    proof, gap = small["certificate"], small["gap"]
    apart = number(gap) if "query" not in row else _digits(gap)
    state = f"overlap by {number(-gap)} m" if proof["touching"] else f"are {apart} m apart"
    verb = "say" if " and " in row["wrong"] else "says"
    when = f" {_digits(small['moment'])} s after the start of the frame" if "moment" in small else ""
    sentences = [
        f"Bodies {i} and {j} {state}{when}; {row['wrong']} {verb} that they {_said(small)}.",
        *([f"Asked: {row['query']}{_within(row)}. The answer is {_ERRORS[row['error']]}."] if "query" in row else []),
        proof_text(proof, (i, j)),
        f"Seen at {row['certificate']['pose']} (question {row['certificate']['call']} of its scene), "
        f"{' against '.join(row['backends'])}; there the gap was {number(row['gap'])} m.",
    ]
    if row["minimised"] is None:
        sentences.append("Asked once and afresh, it was not found again: it may depend on what was asked before.")
    else:
        how = "in one frame" if "moment" in row else "at rest"
        sentences.append(f"{row['minimised_to']} bodies {how} show it by themselves.")
    return sentences


def _said(row: Mapping[str, Any]) -> str:
    """What was told of two bodies, to follow "says that they"."""
    query, told = row.get("query", "collision"), row.get("told")
    if query == "collision":
        return "do not touch" if row["certificate"]["touching"] else "touch"
    if query == "impact":
        return "do not begin to touch in it" if told is None else f"begin to touch at {_digits(told)} s"
    if told is None:
        return "are farther apart than was asked about"
    return "are near" if query == "tolerance" else f"are {_digits(told)} m apart"


def _digits(value: float) -> str:
    """With so many digits that two numbers of which one is wrong look different."""
    return as_given(value, 9)


def _within(row: Mapping[str, Any]) -> str:
    return f" within {number(row['within'])} m" if "within" in row else ""


def proof_text(proof: Mapping[str, Any], bodies: tuple[int, int]) -> str:
    """A certificate, for a person."""
    i, j = bodies
    faces = proof.get("faces") or proof.get("nearest faces")
    between = f" Faces {faces[0]} of body {i} and {faces[1]} of body {j} are the nearest." if faces else ""
    if proof["kind"] == "separating plane":
        normal = ", ".join(_float(part) for part in proof["normal"])
        return (
            f"Proof: along the direction ({normal}) every point of body {i} lies farther than every point of body {j}, "
            f"in exact arithmetic; so a plane parts them.{between}"
        )
    if proof["kind"] == "common point":
        point = ", ".join(_float(part) for part in proof["point"])
        corners = f"{_vertices(len(proof['first']))} of body {i} and {_vertices(len(proof['second']))} of body {j}"
        return (
            f"Proof: the point ({point}) m lies in both; it is a mean of {corners} with positive weights, equal in "
            f"exact arithmetic.{between}"
        )
    if proof["kind"] == "nearest points and separating planes":
        corners = f"{_vertices(len(proof['first']))} of body {i} and {_vertices(len(proof['second']))} of body {j}"
        planes = f"{proof['planes']} {'plane keeps' if proof['planes'] == 1 else 'planes keep'}"
        return (
            f"Proof: two points, means of {corners} with positive weights, are {number(proof['upper'])} m apart, and "
            f"{planes} all parts of one body at least {number(proof['lower'])} m from all parts of the other, both in "
            "exact arithmetic."
        )
    sign = "not more" if proof["touching"] else "more"
    return (
        "Proof: the squared distance of the centres, less the squared sum of the radii, is exactly "
        f"{_short(str(proof['exact']))} m², {sign} than 0."
    )


def _vertices(count: int) -> str:
    return f"{count} {'vertex' if count == 1 else 'vertices'}"


def _float(part: float | str) -> str:
    return as_given(part) if isinstance(part, float | int) else _short(part)


def _short(text: str) -> str:
    return text if len(text) <= 60 else f"{text[:28]}…{text[-28:]}"
