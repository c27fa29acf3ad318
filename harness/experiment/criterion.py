"""A criterion: what a measurement must be for an expectation or a claim to hold."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, Field, ValidationError, model_validator

from harness.experiment.leaves import LEAVES, LeafName, NumericLeafName, plain
from harness.experiment.messages import flow, listed, sentence
from harness.experiment.number import Bounds, Finite, wrong
from harness.experiment.schema import Declared, Text


def _in_type(values: dict[str, Any]) -> dict[str, Any]:
    """Each leaf's value as results hold it, so that `count: 1e3` finds the 1000 of a run."""
    return {name: _one_in_type(name, value) for name, value in values.items()}


def _one_in_type(name: str, value: Any) -> Any:
    if name not in LEAVES:
        return _number(name, value)
    try:
        return plain(LEAVES[name].check(value))
    except ValidationError as error:
        raise wrong(f"{name} {sentence(error.errors(include_url=False)[0], None)}") from None


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise wrong(f"{name} must be a number, not {flow(value)}")
    return value


Where = Annotated[dict[LeafName, Any], AfterValidator(_in_type)]

_PLAIN = ("at_most", "at_least", "equals", "between", "within")
_RATIO = ("at_most", "at_least", "equals", "between")


class Within(Declared):
    """Close to a number."""

    of: Finite = Field(description="the number")
    relative: Annotated[Finite, Field(ge=0)] = Field(description="largest distance, as a part of the number")


class Criterion(Declared):
    """A row of `expect` or `claims`: a metric, the runs it is about, and one condition."""

    metric: Text = Field(description="name of a metric; see `harness list`")
    where: Where = Field({}, description="only the points with these leaf values")
    source: Text | None = Field(None, description="where the claim comes from")
    at_most: Finite | None = Field(None, description="the metric, or the ratio, is this or less")
    at_least: Finite | None = Field(None, description="the metric, or the ratio, is this or more")
    equals: Finite | None = Field(None, description="the metric is exactly this")
    between: Bounds | None = Field(None, description="[low, high], of the metric or of the exponent")
    within: Within | None = Field(None, description="the metric is close to a number")
    exponent_of: NumericLeafName | None = Field(
        None, description="leaf that the metric grows with as a power; the exponent is `between`"
    )
    ratio_to: Where | None = Field(
        None,
        description="leaf values of the points that the metric is divided by; the ratio is `at_most`, `equals`, …",
    )

    @model_validator(mode="after")
    def _one_condition(self) -> Criterion:
        given = [name for name in _PLAIN if getattr(self, name) is not None]
        if self.exponent_of is not None and self.ratio_to is not None:
            raise wrong("exponent_of and ratio_to exclude each other")
        if self.exponent_of is not None and given != ["between"]:
            raise wrong(f"exponent_of needs between: [low, high]{_besides(given, ('between',))}")
        if self.ratio_to is not None and (len(given) != 1 or given[0] not in _RATIO):
            raise wrong(f"ratio_to needs one of {listed(_RATIO, 'or')}{_besides(given, _RATIO)}")
        if self.ratio_to is not None and not self.ratio_to:
            raise wrong("ratio_to must name the leaf values to divide by, such as {algorithm: brute-force}")
        if len(given) != 1:
            options = listed([*_PLAIN, "exponent_of with between", "ratio_to with one of them"], "or")
            count = f"{listed(given)} are too many" if given else "none is given"
            raise wrong(f"needs exactly one of {options}; {count}")
        return self

    @property
    def text(self) -> str:
        """The criterion as a sentence."""
        where = f" where {_conditions(self.where)}" if self.where else ""
        if self.exponent_of is not None and self.between is not None:
            low, high = map(flow, self.between)
            return f"{self.metric}{where} grows with {self.exponent_of} to a power between {low} and {high}"
        if self.ratio_to is not None:
            subject = f"{self.metric}{where}, divided by that where {_conditions(self.ratio_to)},"
        else:
            subject = f"{self.metric}{where}"
        return f"{subject} is {self._bound()}"

    def _bound(self) -> str:
        if self.at_most is not None:
            return f"at most {flow(self.at_most)}"
        if self.at_least is not None:
            return f"at least {flow(self.at_least)}"
        if self.between is not None:
            return f"between {flow(self.between[0])} and {flow(self.between[1])}"
        if self.within is not None:
            return f"within {self.within.relative * 100:g} % of {flow(self.within.of)}"
        return flow(self.equals)


def _besides(given: list[str], allowed: tuple[str, ...]) -> str:
    others = [name for name in given if name not in allowed]
    return f", not {listed(others)}" if others else ""


def _conditions(values: Mapping[str, Any]) -> str:
    return listed([f"{name} is {flow(value)}" for name, value in values.items()])
