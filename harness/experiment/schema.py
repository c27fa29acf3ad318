"""The keys of scene, motion, engine and measure: each with its unit, range and default."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, Tag, model_validator

from harness.experiment.combinations import ENGINE, MOTION, SCENE, Rule, conflicts
from harness.experiment.distribution import Distribution, NonNegativeDistribution, PositiveDistribution
from harness.experiment.number import Bytes, Number, Switch, Vector, Whole, holding, wrong
from harness.vocabulary import (
    DEFAULT_ALGORITHM,
    NATIVE,
    REFERENCE_ALGORITHM,
    Algorithm,
    Family,
    FamilyQuery,
    NativeSize,
    Query,
    ReferenceAlgorithm,
    Response,
    Shape,
)

Text = Annotated[str, Field(min_length=1)]
Positive = Annotated[Number, Field(gt=0)]
NotNegative = Annotated[Number, Field(ge=0)]

# Absurd counts are accepted here and refused where their memory is known; these bounds only keep them in an integer.
MOST_BODIES = 10**9
LARGEST_SEED = 2**63 - 1
MOST_RUNS = 10**9
MOST_THREADS = 64
BodyNumber = Annotated[Whole, Field(ge=0)]


class Declared(BaseModel):
    """The base of all models: they cannot be changed, and an unknown key is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)


def refuse_conflicts(model: BaseModel, rules: tuple[Rule, ...]) -> None:
    """Check a model by the rules of combination; those made in Python are checked too."""
    values = {name: getattr(model, name) for name in type(model).model_fields}
    for conflict in conflicts(values, rules):
        raise wrong(conflict.message.replace("{}", str(values[conflict.leaves[-1]])))


def _turned(quaternion: tuple[float, ...]) -> tuple[float, ...]:
    if not any(quaternion):
        raise wrong("must be a rotation; a quaternion of zeros is none")
    return quaternion


class MeshChoice(Declared):
    """One of these meshes, all equally likely."""

    choice: tuple[Text, ...] = Field(min_length=1, description="[file, file, ...]")


def _mesh_kind(value: object) -> str:
    return "choice" if isinstance(value, Mapping | MeshChoice) else "file"


def _size_kind(value: object) -> str:
    return NATIVE if value == NATIVE else "constant"


MeshFiles = Annotated[
    Annotated[Text, Tag("file")] | Annotated[MeshChoice, Tag("choice")],
    Discriminator(_mesh_kind),
]
BodySize = Annotated[
    Annotated[Positive, Tag("constant")] | Annotated[NativeSize, Tag(NATIVE)], Discriminator(_size_kind)
]


class BodySpec(Declared):
    """One body, given in full."""

    position: Vector | None = Field(None, description="centre [x, y, z], m; needed unless motion has poses")
    mesh: Text | None = Field(None, description="its own mesh, in place of that of the scene")
    velocity: Vector = Field((0.0, 0.0, 0.0), description="[x, y, z], m/s")
    spin: Vector = Field((0.0, 0.0, 0.0), description="angular velocity [x, y, z] in the world frame, rad/s")
    size: BodySize = Field(1.0, description="diameter of the bounding sphere, m; native: as its mesh's file has it")
    mass: Positive | None = Field(None, description="kg; size³ if left out")
    orientation: Annotated[
        tuple[Number, Number, Number, Number], holding(4, "4 numbers (w, x, y, z)"), AfterValidator(_turned)
    ] = Field((1.0, 0.0, 0.0, 0.0), description="quaternion [w, x, y, z], normalised on use")


class SceneSpec(Declared):
    """The bodies, and the box around them."""

    mesh: MeshFiles | None = Field(
        None,
        description="file beside the experiment or in meshes/, package:NAME/FILE, or {choice: [file, ...]}, drawn for "
        "each body; needed unless shape is sphere",
    )
    shape: Shape = Field("mesh", description="what the narrow phase sees: bounding sphere, hull or mesh")
    count: Annotated[Whole, Field(ge=0, le=MOST_BODIES)] | None = Field(None, description="number of random bodies")
    bodies: Annotated[tuple[BodySpec, ...], Field(min_length=1)] | None = Field(
        None, description="the bodies one by one, instead of count"
    )
    size: PositiveDistribution = Field(
        Distribution(1.0), description="diameter of the bounding sphere, m; native: as the mesh's file has it"
    )
    ignore: tuple[Annotated[tuple[BodyNumber, BodyNumber], holding(2, "2 body numbers")], ...] = Field(
        (), description="pairs that are never asked about, [[i, j], ...], bodies counted from 0"
    )
    box: Annotated[tuple[Positive, Positive, Positive], holding(3, "3 sides")] | None = Field(
        None, description="sides [x, y, z], m, centred at the origin"
    )
    box_ratio: Positive | None = Field(None, description="(mean size / side of a cubic box)², instead of box")
    speed: NonNegativeDistribution = Field(
        Distribution.model_validate({"uniform": [0.5, 1.5]}), description="m/s, in a direction uniform on the sphere"
    )
    spin: NonNegativeDistribution = Field(
        Distribution.model_validate({"uniform": [0.0, 3.0]}), description="rad/s, about an axis uniform on the sphere"
    )
    overlap: Literal["reject", "allow"] = Field("reject", description="whether random bodies may overlap at first")
    seed: Annotated[Whole, Field(ge=0, le=LARGEST_SEED)] = Field(259, description="of all random choices in the scene")

    @model_validator(mode="after")
    def _possible(self) -> SceneSpec:
        refuse_conflicts(self, SCENE)
        return self

    @property
    def mesh_choice(self) -> tuple[str, ...]:
        """What a body without a mesh of its own may have."""
        if isinstance(self.mesh, MeshChoice):
            return self.mesh.choice
        return () if self.mesh is None else (self.mesh,)

    @property
    def mesh_names(self) -> tuple[str, ...]:
        """The meshes that the scene names, each once, in the order of the file."""
        own = [body.mesh for body in self.bodies or () if body.mesh is not None]
        return tuple(dict.fromkeys([*self.mesh_choice, *own]))


class MotionSpec(Declared):
    """How the bodies move."""

    poses: Text | None = Field(
        None,
        description="recorded poses, an .npz file beside the experiment, instead of duration, dt, response, speeds",
    )
    duration: NotNegative = Field(10.0, description="simulated time, s")
    dt: Positive = Field(
        1 / 60, description="time from frame to frame, s (no effect on an algorithm that computes events)"
    )
    response: Response = Field("reflect", description="a hit flips velocities, passes impulse, does nothing")
    restitution: Annotated[Number, Field(ge=0, le=1)] = Field(1.0, description="of elastic hits, 0 to 1")

    @model_validator(mode="after")
    def _possible(self) -> MotionSpec:
        refuse_conflicts(self, MOTION)
        return self

    @property
    def frames(self) -> int:
        """The number of frames after the start: frame k is at k·dt, k = 1 … frames."""
        return round(self.duration / self.dt)


class EngineSpec(Declared):
    """How hits are found."""

    backend: Text = Field("fcl", description="library that answers geometry questions; see `harness list`")
    algorithm: Algorithm = Field(
        DEFAULT_ALGORITHM, description="which questions are asked, and when; see `harness list`"
    )
    query: Query = Field("collision", description="what is asked of the pairs of every frame; see `harness list`")
    within: Positive | None = Field(
        None, description="gap up to which pairs are asked about, m; for query tolerance or distance, which need it"
    )
    tolerance: Positive = Field(
        1e-6, description="of size; nearer surfaces touch, and gaps are known to it (no effect on spheres)"
    )
    threads: Annotated[Whole, Field(ge=1, le=MOST_THREADS)] = Field(
        1, description="that share out the pairs of a frame; with more than one, elapsed time tells what they save"
    )
    stages: dict[str, Switch] = Field({}, description="stages forced on or off, for an ablation; see `harness plan`")

    @model_validator(mode="after")
    def _possible(self) -> EngineSpec:
        refuse_conflicts(self, ENGINE)
        return self


class ReferenceSpec(Declared):
    """What errors are measured against."""

    algorithm: ReferenceAlgorithm = Field(
        REFERENCE_ALGORITHM, description="of the reference run; frames would miss hits"
    )
    tolerance: Positive = Field(1e-10, description="its tolerance, of size")


class MeasureSpec(Declared):
    """How often, how long and with how much memory."""

    repeats: Annotated[Whole, Field(ge=1, le=MOST_RUNS)] = Field(5, description="runs of every point")
    timeout: Positive = Field(120.0, description="a run is ended after this time, s")
    memory: Bytes = Field(4 * 1024**3, description="a run may take this much, bytes or text such as 4GiB")
    tier: Literal["default", "long"] = Field("default", description="long: only with `harness sweep --long`")
    max_runs: Annotated[Whole, Field(ge=1, le=MOST_RUNS)] = Field(10_000, description="more runs than this are refused")
    compare: Switch = Field(False, description="hold the backends of the points against each other, after the runs")
    families: tuple[Family, ...] = Field(
        (), description="families of two-body poses that every installed backend is judged on; see `harness compare`"
    )
    family_queries: tuple[FamilyQuery, ...] = Field(
        ("collision",), description="what they are asked of each family: collision, tolerance, distance"
    )
    family_poses: Annotated[Whole, Field(ge=1, le=MOST_RUNS)] = Field(
        100, description="poses of each family, shape and mesh"
    )
    reference: ReferenceSpec | None = Field(None, description="measure errors against such a run")
