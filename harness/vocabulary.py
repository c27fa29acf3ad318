"""The fixed words: what a user may write for a shape, a response or an algorithm, and what a method is named by.

Every folder may import this file; it imports nothing of the program. A new word is a line here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

Shape = Literal["sphere", "hull", "mesh"]
"""What the narrow phase sees of a body: its bounding sphere, its convex hull, or its surface of triangles."""

Query = Literal["collision", "tolerance", "distance", "impact"]
"""What is asked of the pairs of bodies at a frame."""

QUERIES: dict[Query, str] = {
    "collision": "pairs that touch",
    "tolerance": "pairs whose gap is at most `within`",
    "distance": "pairs whose gap is at most `within`, each with its gap and its nearest points",
    "impact": "pairs that begin to touch since the last frame, each with the time",
}
"""The queries, each with the answer of a frame."""

NEAR_QUERIES: tuple[Query, ...] = ("tolerance", "distance")
"""Those that are asked about pairs within a gap, `engine.within`."""

NativeSize = Literal["native"]
"""The size of a body whose mesh is as large as its file says, a unit of the file taken for a metre."""
NATIVE: NativeSize = "native"

MESH_FORMATS = {
    "obj": "v and f: any white space, # anywhere, lines continued by \\, indices from 1 or backwards from where they "
    "stand, with or without texture and normal",
    "ply": "text, or binary in either order of bytes: vertex x y z and face vertex_indices of any types; other "
    "elements and properties passed over",
    "stl": "binary, with any header and any bytes behind the faces; text, keywords in any case, any names, several "
    "solids",
    "off": "OFF, COFF, NOFF, STOFF as text, comments; colours and normals passed over",
    "glb": "glTF 2.0: triangles and strips of the scene, placed by its nodes",
}
"""Mesh files that are read, by the end of their names, each with what is read of it."""

Response = Literal["reflect", "elastic", "none"]
"""What a hit does: mirror each velocity along the line of centres, pass an impulse by mass, nothing."""

Status = Literal["ok", "failed", "timeout", "memory", "crashed", "rejected"]
"""How a run ended."""

FAMILIES = {
    "random": "any orientation, centres from 0.3 of what parts the bounding spheres to beyond it",
    "aligned": "offset along a vertex, an edge or a face direction, and 10⁻⁹ to 10⁻³ rad off it",
    "grazing": "first contact of two features, 10⁻¹⁵ to 10⁻² of a size apart or overlapping",
    "deep": "centres nearer than 0.3 of what parts the bounding spheres",
    "contained": "one body within the other",
    "shared": "a vertex, an edge or the plane of a face in common, or all of the body",
    "sizes": "first contact of bodies whose sizes differ 10 to 10⁴ times",
    "far": "first contact at coordinates of 10³ and 10⁶ sizes",
    "units": "random poses and first contacts of bodies of 10⁻⁴ m and 10⁴ m",
    "resting": "bodies that rest on each other, as the experiment's recorded poses (`motion.poses`) have them",
}
"""Families of poses of two bodies, in which backends go wrong in different ways."""

FamilyQuery = Literal["collision", "tolerance", "distance"]
"""What engines can be asked about poses of families."""

WALLS = ("x-", "x+", "y-", "y+", "z-", "z+")
"""The six walls of a box, in the order in which they answer."""


@dataclass(frozen=True)
class AlgorithmWord:
    """An algorithm as far as its name alone tells.

    Parameters
    ----------
    meaning : which questions it asks, and when
    stepped : whether it steps from frame to frame, `dt` apart; else it computes events, as exactly as `tolerance` says
    own : whether the pairs are found by this program; else by the backend's own broad phase
    kernels : whether kernels of this program decide on the pairs that touch, and the backend only where these cannot
    queries : what it can be asked
    shared : whether several threads can share out the pairs of a frame, as `engine.threads` asks
    """

    meaning: str
    stepped: bool = True
    own: bool = True
    kernels: bool = False
    queries: tuple[Query, ...] = tuple(QUERIES)
    shared: bool = False


ALGORITHMS: dict[str, AlgorithmWord] = {
    "brute-force": AlgorithmWord("every pair, every frame"),
    "grid": AlgorithmWord("pairs from uniform or hierarchical cells sized to the bodies", kernels=True, shared=True),
    "sap": AlgorithmWord(
        "pairs from bodies sorted along an axis, each compared with those its interval overlaps", kernels=True
    ),
    "tree": AlgorithmWord("pairs from a dynamic tree of axis-aligned boxes"),
    "native": AlgorithmWord("the backend's own broad phase", own=False),
    "predictive": AlgorithmWord(
        "from event to event: the next collision of every body is computed, not stepped to",
        stepped=False,
        kernels=True,
        queries=("collision",),
    ),
}

if TYPE_CHECKING:
    Algorithm: TypeAlias = str
    Family: TypeAlias = str
else:
    Algorithm = Literal[tuple(ALGORITHMS)]
    Family = Literal[tuple(FAMILIES)]

DEFAULT_ALGORITHM: Algorithm = "brute-force"
"""What an experiment that names none is run with."""

ReferenceAlgorithm = Literal["predictive"]
REFERENCE_ALGORITHM: ReferenceAlgorithm = "predictive"
"""What errors are measured against: frames would miss hits."""

OWN_BACKEND = "fcl"
"""The backend that answers single questions, so that every algorithm of this program can put its pairs to it."""

OWN = "own"
"""The name under which the engine of this program is asked about one pair, as if it were a backend."""

EXACT_FRAMES = f"{OWN_BACKEND}/grid"
"""The pipeline that is asked of frames, or beside all backends, where any exact one of this program would do."""

LIBRARY_IMPACTS = f"{OWN_BACKEND}/native"
"""The pipeline of a library that is asked for times of impact where none is named."""

ILL_POSED = "ill-posed: which hit comes when, how many there are and what they cost is each method's own"
"""What such a motion is, in plans and on pages."""

METHOD_LEAVES = ("backend", "algorithm", "shape", "query", "tolerance", "stages", "dt")
"""Leaves that say how a question is answered; an experiment that varies one of them compares methods."""

KNOBS = ("dt", "tolerance")
"""Those of them that trade accuracy for time within one method."""


class Abilities(NamedTuple):
    """What a backend says that it can be asked, as far as is known without importing it; None where that is not said.

    Attributes
    ----------
    shapes : that it can hold
    gap_shapes : those whose gaps it tells, where these are not all of them
    queries : that its own pipeline answers
    """

    shapes: tuple[Shape, ...] | None = None
    gap_shapes: tuple[Shape, ...] | None = None
    queries: tuple[Query, ...] | None = None


_UNKNOWN = AlgorithmWord("an algorithm of another version of this program")


def algorithms_of(backend: str, query: Query = "collision") -> tuple[str, ...]:
    """The algorithms that a backend can be asked with, first the one that its name alone stands for.

    One that is not of this program has its own detection only. The one that answers single questions about pairs that
    touch has its own way to gaps and to times, too.

    >>> algorithms_of("pybullet")
    ('native',)
    >>> algorithms_of("fcl")[0]
    'brute-force'
    """
    own = backend == OWN_BACKEND
    both = own and query != "collision"
    return tuple(name for name, word in ALGORITHMS.items() if both or word.own == own)


class PipelineName(NamedTuple):
    """A pipeline as a command or a stored comparison names it: a backend, with an algorithm or alone.

    >>> PipelineName.read("fcl/grid")
    PipelineName(backend='fcl', algorithm='grid')
    >>> PipelineName.read("pybullet").algorithm is None
    True
    """

    backend: str
    algorithm: str | None = None

    @classmethod
    def read(cls, text: str) -> PipelineName:
        """The two parts of a name."""
        backend, stroke, algorithm = text.partition("/")
        return cls(backend, algorithm if stroke else None)


class MethodName(NamedTuple):
    """What answers a run's question, by name: the noun under which runs, verdicts and ranks of a method are kept.

    >>> method = MethodName.of({"backend": "fcl", "algorithm": "grid", "shape": "hull", "count": 50})
    >>> method.pipeline, method.query, method.knob
    ('fcl/grid', 'collision', 'dt')
    """

    backend: str
    algorithm: str
    shape: Shape
    query: Query = "collision"

    @classmethod
    def of(cls, parameters: Mapping[str, Any]) -> MethodName:
        """The method of a run with these leaves; databases of before there were queries know collision alone."""
        given = parameters.get("query")
        query: Query = given if given in QUERIES else "collision"
        return cls(str(parameters["backend"]), str(parameters["algorithm"]), parameters["shape"], query)

    @classmethod
    def read(cls, pipeline: str, shape: Shape, query: Query = "collision") -> MethodName:
        """The method of a pipeline's name, as a command or a stored comparison has it, on a shape.

        A backend alone stands for its own pipeline; of the backend that answers single questions, for every pair.

        >>> MethodName.read("fcl/grid", "hull").algorithm
        'grid'
        >>> MethodName.read("fcl", "hull").pipeline, MethodName.read("pybullet", "hull").pipeline
        ('fcl/brute-force', 'pybullet')
        """
        backend, algorithm = PipelineName.read(pipeline)
        return cls(backend, algorithm or algorithms_of(backend)[0], shape, query)

    @property
    def pipeline(self) -> str:
        """Backend and algorithm as a command takes them: "fcl/grid", and the backend alone for its own pipeline."""
        alone = algorithms_of(self.backend)[0] == self.algorithm and not self._word.own
        return self.backend if alone else f"{self.backend}/{self.algorithm}"

    @property
    def short(self) -> str:
        """The shortest name that `read` understands: "fcl" for every pair put to FCL, else as `pipeline`."""
        alone = MethodName.read(self.backend, self.shape, self.query)
        return self.backend if alone == self else self.pipeline

    @property
    def label(self) -> str:
        """What it is called on the pages, after who does the work: kernels of this program, or the library.

        >>> [MethodName.read(name, "hull").label for name in ("fcl/grid", "fcl/tree", "pybullet")]
        ['own grid', 'fcl tree', 'pybullet']
        """
        if self.kernels:
            return f"own {self.algorithm}"
        return f"{self.backend} {self.algorithm}" if self._word.own else self.backend

    @property
    def kernels(self) -> bool:
        """Whether kernels of this program decide on the pairs, and the backend only where these cannot.

        No library is asked by how much pairs are apart, or when they touch, but for its own pipeline.
        """
        return self._word.kernels or (self._word.own and self.query != "collision")

    @property
    def stepped(self) -> bool:
        """Whether it steps from frame to frame; else it computes events."""
        return self._word.stepped

    @property
    def knob(self) -> str:
        """The leaf that trades accuracy for time: "dt", "tolerance", or "" of a method that is exact."""
        if self.stepped and self.query == "collision":
            return "dt"
        return "" if self.shape == "sphere" else "tolerance"

    @property
    def _word(self) -> AlgorithmWord:
        # a database may hold runs of an algorithm that this version does not have
        return ALGORITHMS.get(self.algorithm, _UNKNOWN)
