"""Which values of leaves cannot stand together, and why. Every such rule is here, once.

A rule is a function of leaf values (all leaves of the parts it looks at, defaults filled in) that returns a `Conflict`
or None. Add a rule by writing it and naming it in one of the tuples at the end. `point_rules` is given a
function that tells what each backend can be asked.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from harness.experiment.messages import listed
from harness.vocabulary import ALGORITHMS, NATIVE, NEAR_QUERIES, Abilities, algorithms_of

Values = Mapping[str, Any]


@dataclass(frozen=True)
class Conflict:
    """Values that cannot stand together.

    Parameters
    ----------
    message : what is wrong; `{}` stands for the values of the last leaf
    leaves : whose values collide, the one to mend last
    excludable : whether leaving the combination out of a sweep is a way to mend it
    """

    message: str
    leaves: tuple[str, ...]
    excludable: bool = False


Rule = Callable[[Values], Conflict | None]


def conflicts(values: Values, rules: Iterable[Rule]) -> Iterator[Conflict]:
    """All conflicts among these leaf values; rules that look at a leaf that is not among them are passed over."""
    for rule in rules:
        try:
            conflict = rule(values)
        except KeyError:  # it looks at a leaf whose value is wrong already
            continue
        if conflict is not None:
            yield conflict


def has_count_or_bodies(values: Values) -> Conflict | None:
    """Bodies are counted, or each is given."""
    if values["count"] is None and values["bodies"] is None:
        return Conflict("a scene needs count (random bodies) or bodies (each of them given)", ("bodies", "count"))
    if values["count"] is not None and values["bodies"] is not None:
        return Conflict("count and bodies exclude each other; give one of them", ("bodies", "count"))
    return None


def has_one_box(values: Values) -> Conflict | None:
    """The box has given sides, or sides that follow from the bodies' size."""
    if values["box"] is not None and values["box_ratio"] is not None:
        return Conflict("box and box_ratio exclude each other; give one of them", ("box_ratio", "box"))
    return None


def has_a_box(values: Values) -> Conflict | None:
    """Bodies that fly need a box; recorded poses are wherever they are."""
    if values["box"] is None and values["box_ratio"] is None and values["poses"] is None:
        return Conflict("a scene needs box ([x, y, z] in m) or box_ratio ((mean size / side)²)", ("box", "box_ratio"))
    return None


def poses_say_where_bodies_are(values: Values) -> Conflict | None:
    """A body has a place of its own, or recorded poses have it."""
    for number, body in enumerate(values["bodies"] or () if values["poses"] is not None else ()):
        if body.position is not None or any((*body.velocity, *body.spin)):
            message = f"poses say where bodies are; bodies[{number}] can have no position, velocity or spin of its own"
            return Conflict(message, ("poses", "bodies"))
    return None


def has_a_mesh(values: Values) -> Conflict | None:
    """Only spheres need no mesh."""
    own = values["bodies"] is not None and all(body.mesh is not None for body in values["bodies"])
    if values["mesh"] is None and not own and values["shape"] != "sphere":
        return Conflict(f"shape {values['shape']} needs a mesh; only shape sphere does without", ("shape", "mesh"))
    return None


def native_sizes_have_a_mesh(values: Values) -> Conflict | None:
    """A size that is read from a mesh needs one."""
    if values["mesh"] is not None:
        return None
    bodies = values["bodies"]
    native = values["size"].is_native if bodies is None else any(
        body.size == NATIVE and body.mesh is None for body in bodies
    )  # fmt: skip
    if native:
        return Conflict("size native is that of a mesh, and there is none; mesh is {}", ("size", "mesh"))
    return None


def ignored_pairs_exist(values: Values) -> Conflict | None:
    """A pair is of two bodies that there are."""
    count = values["count"] if values["bodies"] is None else len(values["bodies"])
    for i, j in values["ignore"]:
        if i == j or max(i, j) >= (count or 0):
            message = f"ignore names the pair [{i}, {j}], which is none of {count} bodies counted from 0"
            return Conflict(message, ("bodies" if values["count"] is None else "count", "ignore"))
    return None


def restitution_has_an_effect(values: Values) -> Conflict | None:
    """Only the elastic response has a restitution."""
    if values["restitution"] != 1 and values["response"] != "elastic":
        message = (
            f"restitution would have no effect with response {values['response']}, only with elastic; it must be 1"
        )
        return Conflict(f"{message}, not {{}}", ("response", "restitution"), excludable=True)
    return None


def frames_can_be_counted(values: Values) -> Conflict | None:
    """The number of a frame, and so its time, is exact in a float."""
    if values["duration"] / values["dt"] >= 2**53:
        return Conflict("a duration of more than 2^53 frames of dt cannot be counted; dt is {}", ("duration", "dt"))
    return None


def backend_has_the_algorithm(values: Values) -> Conflict | None:
    """fcl answers single questions, so that any algorithm can ask them; other backends bring their own detection."""
    backend, algorithms = values["backend"], algorithms_of(values["backend"], values["query"])
    if values["algorithm"] not in algorithms:
        message = f"backend {backend} has no algorithm {{}}, only {listed(algorithms)}"
        return Conflict(message, ("backend", "algorithm"), excludable=True)
    return None


def within_is_asked_for(values: Values) -> Conflict | None:
    """Only the queries about pairs that are near need to know how near."""
    query, within = values["query"], values["within"]
    if query in NEAR_QUERIES and within is None:
        return Conflict(
            f"query {query} needs within, the gap up to which pairs are asked about (m)", ("within", "query")
        )
    if query not in NEAR_QUERIES and within is not None:
        message = f"within would have no effect with query {query}, only with {listed(NEAR_QUERIES, 'or')}"
        return Conflict(f"{message}; it must be null, not {{}}", ("query", "within"), excludable=True)
    return None


def algorithm_answers_the_query(values: Values) -> Conflict | None:
    """What is computed from event to event has no frames to ask about."""
    query, algorithm = values["query"], values["algorithm"]
    answered = ALGORITHMS[algorithm].queries
    if query not in answered:
        message = f"algorithm {algorithm} cannot be asked query {{}}, only {listed(answered)}"
        return Conflict(message, ("algorithm", "query"), excludable=True)
    return None


def threads_have_pairs_to_share(values: Values) -> Conflict | None:
    """Several threads share out the pairs of frames, where kernels of this program go through them."""
    if values["threads"] == 1:
        return None
    if not ALGORITHMS[values["algorithm"]].shared:
        able = listed([name for name, word in ALGORITHMS.items() if word.shared])
        message = f"algorithm {values['algorithm']} runs on one thread; threads {{}} can be had with {able}"
        return Conflict(message, ("algorithm", "threads"), excludable=True)
    if values["query"] != "collision":
        message = f"query {values['query']} runs on one thread, not on {{}}; query collision can use several"
        return Conflict(message, ("query", "threads"), excludable=True)
    return None


def poses_are_frames(values: Values) -> Conflict | None:
    """Recorded motion is what it is: no event of it can be computed ahead, or change it."""
    if values["poses"] is not None and not ALGORITHMS[values["algorithm"]].stepped:
        message = "recorded poses are looked at frame by frame; algorithm {} has no use of them"
        return Conflict(message, ("poses", "algorithm"), excludable=True)
    return None


def bodies_pass_through(values: Values) -> Conflict | None:
    """A response answers pairs that touch; without one the motion is the same for every method and every query."""
    query, response = values["query"], values["response"]
    if query != "collision" and response != "none" and values["poses"] is None:
        message = f"query {query} needs response none, for only pairs that touch can be answered; response is {{}}"
        return Conflict(message, ("query", "response"), excludable=True)
    return None


SCENE: tuple[Rule, ...] = (
    has_count_or_bodies,
    has_one_box,
    has_a_mesh,
    native_sizes_have_a_mesh,
    ignored_pairs_exist,
)
MOTION: tuple[Rule, ...] = (restitution_has_an_effect, frames_can_be_counted)
ENGINE: tuple[Rule, ...] = (
    backend_has_the_algorithm,
    within_is_asked_for,
    algorithm_answers_the_query,
    threads_have_pairs_to_share,
)
POINT: tuple[Rule, ...] = (
    *SCENE,
    has_a_box,
    *MOTION,
    *ENGINE,
    poses_are_frames,
    poses_say_where_bodies_are,
    bodies_pass_through,
)

AbilitiesOf = Callable[[str], Abilities]
"""What the backend of a name can be asked."""


def point_rules(abilities_of: AbilitiesOf | None = None) -> tuple[Rule, ...]:
    """The rules for all leaves of a point; without abilities nothing is known of backends."""
    if abilities_of is None:
        return POINT
    of_backends = (backend_answers_the_query, backend_has_the_shape, backend_has_gaps_of_the_shape)
    return (*POINT, *(partial(rule, abilities_of) for rule in of_backends))


def backend_answers_the_query(abilities_of: AbilitiesOf, values: Values) -> Conflict | None:
    """Methods of this program answer every query by kernels of their own; a library what it has been taught."""
    if ALGORITHMS[values["algorithm"]].own:
        return None
    backend, query = values["backend"], values["query"]
    answered = abilities_of(backend).queries
    if answered is not None and query not in answered:
        message = f"backend {backend} cannot be asked query {{}}, only {listed(answered)}"
        return Conflict(message, ("backend", "query"), excludable=True)
    return None


def backend_has_the_shape(abilities_of: AbilitiesOf, values: Values) -> Conflict | None:
    """What a library cannot hold it cannot be asked about."""
    backend = values["backend"]
    shapes = abilities_of(backend).shapes
    if shapes is not None and values["shape"] not in shapes:
        message = f"backend {backend} has no shape {{}}, only {listed(shapes)}"
        return Conflict(message, ("backend", "shape"), excludable=True)
    return None


def backend_has_gaps_of_the_shape(abilities_of: AbilitiesOf, values: Values) -> Conflict | None:
    """What a library tells of some shapes it may not tell of all."""
    backend, query = values["backend"], values["query"]
    shapes = abilities_of(backend).gap_shapes
    if query in NEAR_QUERIES and shapes is not None and values["shape"] not in shapes:
        message = f"backend {backend} has no gaps of shape {{}}, only of {listed(shapes)}"
        return Conflict(message, ("backend", "query", "shape"), excludable=True)
    return None
