"""Any experiment that is right loads, again and again the same; any that is wrong is refused in sentences."""

import jsonschema
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.errors import InputError
from harness.experiment.json_schema import json_schema
from harness.experiment.leaves import LEAVES
from harness.experiment.load import KEYS, load_text
from harness.experiment.schema import MeasureSpec
from tests.conftest import examples

CHECKER = jsonschema.Draft202012Validator(json_schema())

NUMBER = st.floats(0.1, 1e6).map(float)
DISTRIBUTION = (
    NUMBER
    | st.tuples(NUMBER, NUMBER).map(lambda pair: {"uniform": sorted(pair)})
    | st.lists(NUMBER, min_size=1, max_size=4).map(lambda values: {"choice": values})
)
VECTOR = st.lists(st.floats(-100, 100).filter(lambda x: x == 0 or abs(x) > 1e-29), min_size=3, max_size=3)
BODY = st.fixed_dictionaries({"position": VECTOR}, optional={"velocity": VECTOR, "spin": VECTOR, "mass": NUMBER})
LEAF = {
    "shape": st.just("sphere"),
    "size": DISTRIBUTION,
    "speed": DISTRIBUTION,
    "spin": DISTRIBUTION,
    "overlap": st.sampled_from(["reject", "allow"]),
    "seed": st.integers(0, 2**63 - 1),
    "duration": st.floats(1, 100),
    "dt": st.floats(0.01, 10),
    "response": st.sampled_from(["reflect", "elastic", "none"]),
    "algorithm": st.sampled_from(["brute-force", "grid", "tree", "predictive"]),
    "tolerance": st.floats(1e-12, 0.1),
    "stages": st.dictionaries(st.sampled_from(["hull_axis", "walls"]), st.booleans()),
    "count": st.integers(0, 10**9),
    "bodies": st.lists(BODY, min_size=1, max_size=3),
    "box": st.lists(NUMBER, min_size=3, max_size=3),
    "box_ratio": st.floats(1e-6, 1),
}


@st.composite
def files(draw: st.DrawFn) -> dict[str, object]:
    """Experiments that are right, with some leaves fixed and some varying."""
    chosen = draw(st.sets(st.sampled_from(sorted(LEAF)))) - {"count", "bodies", "box", "box_ratio", "shape"}
    chosen |= {draw(st.sampled_from(["count", "bodies"])), draw(st.sampled_from(["box", "box_ratio"]))}
    varying = draw(st.sets(st.sampled_from(sorted(chosen)), max_size=3))
    file: dict[str, object] = {"title": draw(st.text("abc <>&'\"é", min_size=1))}
    file["scene"] = {"shape": "sphere"}
    for leaf in chosen - varying:
        file.setdefault(LEAVES[leaf].section, {})[leaf] = draw(LEAF[leaf])  # type: ignore[index]
    file["sweep"] = {leaf: draw(st.lists(LEAF[leaf], min_size=1, max_size=3)) for leaf in varying}
    return file


@pytest.mark.slow
@settings(deadline=None)
@given(files())
def test_a_right_experiment_loads_and_its_points_load_again(file: dict[str, object]) -> None:
    experiment = load_text(yaml.safe_dump(file, allow_unicode=True, sort_keys=False), "exp.yaml")
    assert experiment.points
    for point in experiment.points:
        again: dict[str, object] = {"title": "t"}
        for leaf, value in point.parameters.items():
            again.setdefault(LEAVES[leaf].section, {})[leaf] = value  # type: ignore[index]
        assert load_text(yaml.safe_dump(again), "exp.yaml").points == (point,)


@settings(deadline=None, max_examples=examples(50))
@given(files())
def test_a_right_experiment_is_taken_by_editors(file: dict[str, object]) -> None:
    assert list(CHECKER.iter_errors(file)) == []


JUNK = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5) | st.sampled_from(sorted(LEAVES)),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.sampled_from([*LEAVES, "uniform", "choice", "metric", "where", "at_most", "x"]), inner)
    ),
    max_leaves=15,
)
LEAVES_OF_JUNK = st.dictionaries(st.sampled_from(sorted(LEAVES)), JUNK, max_size=5)
FILE_OF_JUNK = st.dictionaries(st.sampled_from([*KEYS, "titel"]), JUNK) | st.fixed_dictionaries(
    dict.fromkeys(("scene", "motion", "engine", "sweep"), LEAVES_OF_JUNK),
    optional={key: st.lists(LEAVES_OF_JUNK, max_size=3) for key in ("zip", "exclude", "include")},
)


@pytest.mark.slow
@settings(deadline=None)
@given(FILE_OF_JUNK, st.dictionaries(st.sampled_from([*LEAVES, *MeasureSpec.model_fields, "x"]), JUNK, max_size=2))
def test_junk_in_the_form_of_an_experiment_is_refused_in_sentences(file: object, set: dict[str, object]) -> None:
    try:
        load_text(yaml.safe_dump(file, allow_unicode=True), "exp.yaml", set)
    except InputError as error:
        for problem in error.problems:
            assert "\n" not in str(problem)
            assert "validation error" not in str(problem)
