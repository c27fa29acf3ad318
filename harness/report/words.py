"""What leaves, metrics and scenes are called on the pages."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import PurePosixPath
from typing import Any

from harness.measure.metrics import METRICS
from harness.report.quantity import leaf_text, number, plural

_LEAVES = {
    "count": "number of bodies",
    "faces": "faces of the mesh",
    "hull_vertices": "vertices of the hull",
    "packing": "packing (volume of spheres / volume of box)",
    "box_side": "box side, m",
    "box_ratio": "box ratio (body size / box side)²",
    "dt": "time step, s",
    "size": "body size, m",
    "speed": "speed, m/s",
    "spin": "spin, rad/s",
    "duration": "simulated time, s",
    "tolerance": "tolerance, of body size",
    "backend": "backend",
    "algorithm": "algorithm",
    "shape": "shape",
    "mesh": "mesh",
    "restitution": "restitution",
    "response": "response",
    "seed": "seed",
    "stages": "stages forced",
}
# Leaves whose values explain themselves in a label; others are written "leaf value".
_SELF_EVIDENT = ("method", "backend", "algorithm", "mesh", "response", "stages")
VERDICTS = ("holds", "fails", "undecided")
_OF_SEVERAL = {"holds": "hold", "fails": "fail"}
# What `scene_text` says of a scene already.
SCENE_LEAVES = ("count", "mesh", "faces", "hull_vertices", "shape", "box_ratio", "box", "box_side", "packing")


def capital(text: str) -> str:
    """The text with a capital at its beginning, the rest as it is."""
    return text[:1].upper() + text[1:]


def verdict_text(verdict: str, count: int) -> str:
    """A verdict as it is said of so many rows of `expect` or `claims`.

    >>> verdict_text("holds", 1), verdict_text("holds", 2), verdict_text("undecided", 2)
    ('holds', 'hold', 'undecided')
    """
    return _OF_SEVERAL.get(verdict, verdict) if count != 1 else verdict


def verdicts_text(verdicts: Iterable[str]) -> str:
    """How many rows came to which verdict.

    >>> verdicts_text(["holds", "fails", "holds"])
    '2 hold, 1 fails'
    """
    counts = Counter(verdicts)
    return ", ".join(
        f"{number(counts[verdict])} {verdict_text(verdict, counts[verdict])}" for verdict in VERDICTS if counts[verdict]
    )


def metric_title(name: str) -> str:
    """A metric in words: "object/object test time"."""
    return METRICS[name].heading if name in METRICS else name.replace("_", " ")


def in_words(statement: str, metric: str) -> str:
    """What was found of a metric, which stands at its beginning, with the metric in words.

    >>> in_words("pair_seconds at count=10 is 2.4 times that for count=5", "pair_seconds")
    'object/object test time at count=10 is 2.4 times that for count=5'
    >>> in_words("pair_tests grows as count^2.08", "pair_tests")
    'number of object/object tests grows as count^2.08'
    """
    rest, title = statement.removeprefix(f"{metric} "), metric_title(metric)
    if rest == statement:
        return statement
    counted = "number of " if title.split(" per ")[0].endswith("s") else ""
    return f"{counted}{title} {rest}"


def metric_unit(name: str) -> str:
    """The unit of a metric as it is written behind a number, "1" for none or a metric this version does not know."""
    unit = METRICS[name].unit if name in METRICS else "1"
    return unit.removeprefix("1") if unit != "1" else unit


def is_noisy(name: str) -> bool:
    """Whether repeats of the metric vary, so that it has an interval."""
    return name not in METRICS or METRICS[name].noisy


def leaf_title(leaf: str) -> str:
    """A leaf in words: "number of bodies"."""
    return _LEAVES.get(leaf, leaf.replace("_", " "))


def leaf_label(leaf: str, value: object) -> str:
    """A leaf and its value as a label.

    >>> leaf_label("backend", "fcl"), leaf_label("shape", "hull"), leaf_label("dt", 1 / 60)
    ('fcl', 'shape hull', 'dt 1/60')
    >>> leaf_label("within", None)
    'no within'
    """
    if value is None or value != value:  # NaN, as tables have it
        return f"no {leaf}"
    text = leaf_text(value)
    return text if leaf in _SELF_EVIDENT else f"{leaf} {text}"


def more_is_better(name: str) -> bool:
    """Whether the larger of two values of the metric wins."""
    return name in METRICS and METRICS[name].more_is_better


def is_ranked(name: str) -> bool:
    """Whether less, or more, of the metric is better: of what happens in a scene there is no best."""
    return name not in METRICS or METRICS[name].ranked


def scene_text(parameters: Mapping[str, Any]) -> str:
    """A scene in a phrase, and what is asked of it where that is not collision.

    >>> scene_text({"count": 40, "mesh": "pumpkin-1753.ply", "shape": "hull", "packing": 0.0971}).replace("\u00a0", " ")
    '40 bodies of pumpkin-1753 (hull) at packing 0.0971'
    >>> scene_text({"count": 40, "mesh": {"choice": ["a.ply", "b.ply"]}, "shape": "mesh"}).replace("\u00a0", " ")
    '40 bodies of 2 meshes (mesh)'
    >>> scene_text({"bodies": [{"mesh": "a.ply"}, {"mesh": "b.ply"}], "shape": "mesh"}).replace("\u00a0", " ")
    '2 bodies of 2 meshes (mesh)'
    >>> scene_text({"bodies": [{"mesh": "a.ply"}], "mesh": "of-none.ply", "shape": "mesh"}).replace("\u00a0", " ")
    '1 body of a (mesh)'
    >>> scene_text({"count": 9, "shape": "sphere", "query": "distance", "within": 0.05}).replace("\u00a0", " ")
    '9 spheres, query distance within 0.05 m'
    """
    count, listed = parameters.get("count"), parameters.get("bodies")
    count = len(listed) if count is None and isinstance(listed, list | tuple) else count
    bodies = plural(int(count), "body", "bodies") if isinstance(count, int | float) else "bodies"
    shape = parameters.get("shape")
    if shape == "sphere":
        bodies = bodies.replace("bodies", "spheres").replace("body", "sphere")
    elif names := _mesh_names(parameters):
        what = PurePosixPath(names[0]).stem if len(names) == 1 else f"{len(names)} meshes"
        bodies += f" of {what} ({shape})"
    packing = parameters.get("packing")
    scene = f"{bodies} at packing {number(packing)}" if isinstance(packing, int | float) else bodies
    return ", ".join(part for part in (scene, _query_text(parameters)) if part)


def _query_text(parameters: Mapping[str, Any]) -> str:
    query, within = parameters.get("query"), parameters.get("within")
    if query is None or query == "collision":
        return ""
    return f"query {query}" if within is None else f"query {query} within {leaf_text(within)}\u00a0m"


def _mesh_names(parameters: Mapping[str, Any]) -> list[str]:
    """The meshes that bodies may have, each once."""
    mesh, bodies = parameters.get("mesh"), parameters.get("bodies")
    chosen = mesh["choice"] if isinstance(mesh, Mapping) else [mesh]
    own = [body.get("mesh") for body in bodies] if isinstance(bodies, list | tuple) else [None]
    shared = chosen if None in own else []
    return [str(name) for name in dict.fromkeys([*shared, *own]) if name]
