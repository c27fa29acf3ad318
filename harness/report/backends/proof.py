"""A proof in words and numbers: what the judge found of a case, and how anyone can check it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from harness.report.quantity import number


def sentences_of(row: Mapping[str, Any]) -> list[str]:
    """What is true, who is wrong, the proof, where it was seen, and how small it was made."""
    small = row["minimised"] or row
    i, j = small["bodies"]
    proof, gap = small["certificate"], small["gap"]
    state = f"overlap by {number(-gap)} m" if proof["touching"] else f"are {number(gap)} m apart"
    says = "do not touch" if proof["touching"] else "touch"
    verb = "say" if " and " in row["wrong"] else "says"
    said = [
        f"Bodies {i} and {j} {state}; {row['wrong']} {verb} that they {says}.",
        proof_text(proof, (i, j)),
        f"Seen at {row['certificate']['pose']} (question {row['certificate']['call']} of its scene), "
        f"{' against '.join(row['backends'])}; there the gap was {number(row['gap'])} m.",
    ]
    if row["minimised"] is None:
        said.append("Asked once and afresh, the backend is right: it depends on what was asked before.")
    else:
        said.append(f"{row['minimised_to']} bodies at rest show it by themselves.")
    return said


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
    sign = "not more" if proof["touching"] else "more"
    return (
        "Proof: the squared distance of the centres, less the squared sum of the radii, is exactly "
        f"{_short(str(proof['exact']))} m², {sign} than 0."
    )


def _vertices(count: int) -> str:
    return f"{count} {'vertex' if count == 1 else 'vertices'}"


def _float(part: float | str) -> str:
    return f"{part:.6g}".replace("-", "−") if isinstance(part, float | int) else _short(part)


def _short(text: str) -> str:
    return text if len(text) <= 60 else f"{text[:28]}…{text[-28:]}"
