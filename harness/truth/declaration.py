"""What a set of cases is to be made of, as a YAML file declares it: families of pairs, and how many of each."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, NamedTuple

from pydantic import Field, ValidationError

from harness.errors import InputError, NotInstalledError, Problem
from harness.experiment.distribution import Distribution, NonNegativeDistribution, PositiveDistribution
from harness.experiment.document import read_document
from harness.experiment.mesh_location import locate_mesh
from harness.experiment.number import Whole
from harness.experiment.problems import FileProblems
from harness.experiment.schema import LARGEST_SEED, Declared, Positive, Text
from harness.vocabulary import Shape

MOST_CASES = 10**6


class FamilySpec(Declared):
    """One family of pairs."""

    count: Annotated[Whole, Field(ge=1, le=MOST_CASES)] = Field(description="how many pairs")
    meshes: Annotated[tuple[Text, ...], Field(min_length=1)] = Field(
        description="files beside this one or in meshes/, or package:NAME/FILE; both bodies are drawn from them"
    )
    shapes: Annotated[tuple[Shape, ...], Field(min_length=1)] = Field(("mesh",), description="drawn for each pair")
    size: PositiveDistribution = Field(Distribution(1.0), description="of the first body, diameter, m")
    ratio: PositiveDistribution = Field(Distribution(1.0), description="size of the second body to that of the first")
    speed: PositiveDistribution = Field(Distribution(1.0), description="of one body as seen from the other, m/s")
    spin: NonNegativeDistribution = Field(Distribution(0.0), description="of either body, rad/s, in any direction")
    window: Positive = Field(4.0, description="s, until when it is asked whether they touch")


class Families(Declared):
    """The families that there are; see `families.py` for how the pairs of each are drawn."""

    random: FamilySpec | None = None
    grazing: FamilySpec | None = None
    near_misses: FamilySpec | None = None
    parting_ribs: FamilySpec | None = None
    resting: FamilySpec | None = None
    flat_contacts: FamilySpec | None = None
    fast_spins: FamilySpec | None = None
    size_ratio: FamilySpec | None = None
    interlocked: FamilySpec | None = None
    never: FamilySpec | None = None


class TruthSpec(Declared):
    """A whole file."""

    title: Text
    question: Text | None = None
    seed: Annotated[Whole, Field(ge=0, le=LARGEST_SEED)] = 1
    families: Families


class TruthDeclaration(NamedTuple):
    """A file and the meshes that it names.

    Attributes
    ----------
    path : of the file
    spec : what it says
    families : by name, those that it declares
    meshes : the file that each name of a mesh means
    problems : of the file, so that a mesh can be found wrong at its place
    text : of the file
    """

    path: Path
    spec: TruthSpec
    families: dict[str, FamilySpec]
    meshes: dict[str, Path]
    problems: FileProblems
    text: str


def load_truth(path: Path) -> TruthDeclaration:
    """Read a declaration.

    Raises
    ------
    InputError
        With everything that is wrong with it, each with its line and column.
    """
    try:
        text = path.read_bytes()
    except OSError as error:
        raise InputError([Problem(f"the file cannot be read: {error.strerror}", str(path))]) from None
    document = read_document(text, str(path))
    problems = FileProblems(document)
    try:
        spec = TruthSpec.model_validate(document.value)
    except ValidationError as error:
        problems.add_errors((), error, TruthSpec)
        problems.raise_any()
        raise
    families = {name: given for name in Families.model_fields if (given := getattr(spec.families, name)) is not None}
    if not families:
        problems.add(("families",), "needs at least one family of pairs")
    meshes: dict[str, Path] = {}
    for name, family in families.items():
        for place, reference in enumerate(family.meshes):
            try:
                meshes[reference] = locate_mesh(reference, path.parent)
            except NotInstalledError as error:
                problems.add_not_installed(("families", name, "meshes", place), str(error))
            except InputError as error:
                problems.add(("families", name, "meshes", place), str(error))
    problems.raise_any()
    return TruthDeclaration(path, spec, families, meshes, problems, text.decode("utf-8-sig"))
