"""A quantity that differs from body to body: a number, `{uniform: [low, high]}` or `{choice: [...]}`.

A size may be `native` too: that of the mesh in its file.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, RootModel, Tag

from harness.experiment.messages import shown
from harness.experiment.number import Number, holding, rising, wrong
from harness.vocabulary import NATIVE, NativeSize

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Uniform(BaseModel):
    """Any value between two, all equally likely."""

    model_config = ConfigDict(frozen=True, extra="forbid")
    uniform: Annotated[tuple[Number, Number], holding(2, "a low and a high value"), AfterValidator(rising)] = Field(
        description="[low, high]"
    )


class Choice(BaseModel):
    """One of these values, all equally likely."""

    model_config = ConfigDict(frozen=True, extra="forbid")
    choice: tuple[Number, ...] = Field(min_length=1, description="[value, value, ...]")


def _kind(value: Any) -> str | None:
    if isinstance(value, Uniform) or (isinstance(value, Mapping) and "uniform" in value):
        return "uniform"
    if isinstance(value, Choice) or (isinstance(value, Mapping) and "choice" in value):
        return "choice"
    if isinstance(value, Mapping | list | tuple):
        return None
    return NATIVE if value == NATIVE else "constant"


class Distribution(
    RootModel[
        Annotated[
            Annotated[Number, Tag("constant")]
            | Annotated[Uniform, Tag("uniform")]
            | Annotated[Choice, Tag("choice")]
            | Annotated[NativeSize, Tag(NATIVE)],
            Discriminator(
                _kind,
                custom_error_type="sentence",
                custom_error_message="must be a number, {uniform: [low, high]} or {choice: [value, ...]}",
            ),
        ]
    ]
):
    """A number, `{uniform: [low, high]}` or `{choice: [values]}`; its JSON is what YAML has.

    >>> sizes = Distribution.model_validate({"uniform": [0.5, 1.5]})
    >>> sizes.kind, sizes.values, sizes.mean
    ('uniform', (0.5, 1.5), 1.0)
    >>> Distribution.model_validate({"choice": [1, 2, 6]}).mean
    3.0
    """

    model_config = ConfigDict(frozen=True)

    @property
    def kind(self) -> Literal["constant", "uniform", "choice"] | NativeSize:
        """Which of the four it is."""
        if self.root == NATIVE:
            return NATIVE
        if isinstance(self.root, Uniform):
            return "uniform"
        return "choice" if isinstance(self.root, Choice) else "constant"

    @property
    def is_native(self) -> bool:
        """Whether the meshes say it, each in its file."""
        return self.kind == NATIVE

    @property
    def values(self) -> tuple[float, ...]:
        """The one value, the low and the high one, or all that can be chosen; none where the meshes say it."""
        if isinstance(self.root, str):
            return ()
        if isinstance(self.root, Uniform):
            return self.root.uniform
        return self.root.choice if isinstance(self.root, Choice) else (self.root,)

    @property
    def mean(self) -> float:
        """The expected value."""
        return sum(self.values) / len(self.values)

    def sample(self, rng: np.random.Generator, n: int) -> NDArray[np.float64]:
        """Draw `n` values as an (n,) array. A constant draws nothing from `rng`.

        >>> Distribution(2.0).sample(None, 3)
        array([2., 2., 2.])
        """
        import numpy as np

        if self.kind == "uniform":
            low, high = self.values
            return rng.uniform(low, high, n)
        if self.kind == "choice":
            return rng.choice(np.array(self.values), n)
        return np.full(n, self.values[0])


def _positive(distribution: Distribution) -> Distribution:
    if min(distribution.values, default=1.0) <= 0:
        raise wrong(f"must be greater than 0, not {shown(min(distribution.values))}")
    return distribution


def _not_negative(distribution: Distribution) -> Distribution:
    if distribution.kind == NATIVE:
        raise wrong("must be a number, {uniform: [low, high]} or {choice: [value, ...]}; only a size can be native")
    if min(distribution.values) < 0:
        raise wrong(f"must be at least 0, not {shown(min(distribution.values))}")
    return distribution


PositiveDistribution = Annotated[Distribution, AfterValidator(_positive)]
NonNegativeDistribution = Annotated[Distribution, AfterValidator(_not_negative)]
