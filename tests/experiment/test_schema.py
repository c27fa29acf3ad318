"""What values an experiment takes, and in which words others are refused."""

from collections.abc import Callable

import numpy as np
import pytest
from pydantic import ValidationError

from harness.experiment.criterion import Criterion
from harness.experiment.distribution import Distribution
from harness.experiment.experiment import Experiment
from harness.experiment.schema import BodySpec, EngineSpec, MeasureSpec, MotionSpec, SceneSpec

Read = Callable[..., Experiment]
ProblemsIn = Callable[..., list[str]]

SPHERES = "title: t\nscene: {shape: sphere, count: 2, box: [1, 1, 1]}\n"


def said(text: str, problems_in: ProblemsIn) -> str:
    (problem,) = problems_in(text)
    return problem


def test_everything_but_title_bodies_box_and_mesh_has_the_default_of_the_contract(read: Read) -> None:
    experiment = read("title: t\nscene: {mesh: cube.ply, count: 5, box_ratio: 1/100}\n")
    (point,) = experiment.points
    assert point.parameters == {
        "mesh": "cube.ply",
        "shape": "mesh",
        "count": 5,
        "bodies": None,
        "size": 1.0,
        "box": None,
        "box_ratio": 0.01,
        "speed": {"uniform": [0.5, 1.5]},
        "spin": {"uniform": [0.0, 3.0]},
        "overlap": "reject",
        "seed": 259,
        "ignore": [],
        "poses": None,
        "duration": 10.0,
        "dt": 1 / 60,
        "response": "reflect",
        "restitution": 1.0,
        "backend": "fcl",
        "algorithm": "brute-force",
        "query": "collision",
        "within": None,
        "tolerance": 1e-6,
        "threads": 1,
        "stages": {},
    }
    measure = MeasureSpec(repeats=5, timeout=120, memory=4 * 1024**3, tier="default", max_runs=10_000, reference=None)
    assert experiment.measure == measure
    assert (experiment.expect, experiment.claims, experiment.published, experiment.report) == ((), (), None, None)


@pytest.mark.parametrize(
    ("scene", "problem"),
    [
        ("count: -3", "count must be at least 0, not -3"),
        ("count: 2.5", "count must be a whole number, not 2.5"),
        ("count: ten", 'count must be a whole number, not "ten"'),
        ("count: '5'", 'count must be a whole number, not "5"'),
        ("count: on", "count must be a whole number, not true"),
        ("count: 1_000_000_001", "count must be at most 1000000000, not 1000000001"),
        ("count: 1" + "0" * 350, "count must be at most 1000000000, not 1000"),
        ("count: .nan", "count must be a whole number, not nan"),
        ("size: 0", "size must be greater than 0, not 0"),
        ("size: .inf", "size must be a finite number, not inf"),
        ("size: {uniform: [2, 1]}", "uniform must rise from low to high, not fall from 2 to 1"),
        ("size: {uniform: [0, 1]}", "size must be greater than 0, not 0"),
        ("size: {uniform: [1]}", "uniform must hold a low and a high value, not 1 value"),
        ("size: {choice: []}", "choice must not be empty"),
        ("size: {choise: [1]}", "size must be a number, {uniform: [low, high]} or {choice: [value, ...]}"),
        ("size: {uniform: [1, 2], choice: [1]}", 'unknown key "choice"; there is only uniform'),
        ("size: big", 'size must be a number, not "big"'),
        ("speed: {choice: [1, -1]}", "speed must be at least 0, not -1"),
        ("box: [1, 2]", "box must hold 3 sides, not 2"),
        ("box: [1, 2, 0]", "box must be greater than 0, not 0"),
        ("box: 5", "box must be a list, not 5"),
        ("seed: -1", "seed must be at least 0, not -1"),
        ("shape: spheer", 'shape must be sphere, hull or mesh, not "spheer"; did you mean "sphere"?'),
        ("overlap: no", "overlap must be reject or allow, not false"),
        ("mesh: 5", "mesh must be text, not 5; put it in quotes if text is meant"),
        ("speed: 1e-31", "speed must be 0 or between 1e-30 and 1e+30 in magnitude, not 1e-31"),
    ],
)
def test_a_wrong_value_in_the_scene_is_named_at_its_place(scene: str, problem: str, problems_in: ProblemsIn) -> None:
    rest = {"shape": "sphere", "count": 2, "box": "[1, 1, 1]"}
    rest.pop(scene.split(":")[0], None)
    text = "title: t\nscene:\n  " + scene + "\n" + "".join(f"  {key}: {value}\n" for key, value in rest.items())
    place, _, message = said(text, problems_in).partition(": ")
    assert message.startswith(problem)
    assert place.startswith("exp.yaml:3:")


@pytest.mark.parametrize(
    ("more", "problem"),
    [
        ("motion: {dt: 0}", "exp.yaml:3:14: dt must be greater than 0, not 0"),
        ("motion: {dt: }", "exp.yaml:3:14: dt must be a number, not nothing"),
        ("motion: {duration: -1}", "exp.yaml:3:20: duration must be at least 0, not -1"),
        ("motion: {response: elastic, restitution: 1.1}", "exp.yaml:3:42: restitution must be at most 1, not 1.1"),
        ("motion: {restitution: 0.5}", "exp.yaml:3:23: restitution would have no effect with response reflect"),
        ("motion: {duration: 1e20, dt: 1e-20}", "exp.yaml:3:30: a duration of more than 2^53 frames"),
        ("motion: 5", "exp.yaml:3:9: motion must be a mapping of keys to values, not 5"),
        ("engine: {backend: pybullet}", "exp.yaml:3:19: backend pybullet has no algorithm brute-force, only native"),
        ("engine: {algorithm: native}", "exp.yaml:3:21: backend fcl has no algorithm native, only brute-force, grid"),
        ("engine: {tolerance: 0}", "exp.yaml:3:21: tolerance must be greater than 0, not 0"),
        ("engine: {stages: {a: 5}}", "exp.yaml:3:22: a must be on or off, not 5"),
        ("engine: {backend: ''}", "exp.yaml:3:19: backend must not be empty"),
        ("measure: {repeats: 0}", "exp.yaml:3:20: repeats must be at least 1, not 0"),
        ("measure: {memory: 4 GOB}", "exp.yaml:3:19: memory must be a number of bytes such as 4GiB or 512 MiB, not"),
        ("measure: {memory: on}", "exp.yaml:3:19: memory must be a number of bytes such as 4GiB or 512 MiB, not true"),
        ("measure: {memory: 0}", "exp.yaml:3:19: memory must be at least 1 byte"),
        ("measure: {teir: long}", 'exp.yaml:3:11: unknown key "teir"; did you mean "tier"?'),
        ("measure: {reference: {tolerance: 0}}", "exp.yaml:3:34: tolerance must be greater than 0, not 0"),
        ("published: {rows: [{a: on}], source: s}", "exp.yaml:3:24: a must be a number or text, not true"),
        ("published: {rows: [5], source: s}", "exp.yaml:3:20: a row of rows must be a mapping"),
        ("published: {}", 'exp.yaml:3:12: "source" is missing'),
        ("report: {x: fases}", 'exp.yaml:3:13: unknown leaf "fases"; did you mean "faces"?'),
        ("report: {y: 5}", "exp.yaml:3:13: y must be the name of a metric or a list of names, not 5"),
        ("dt: 3", 'exp.yaml:3:1: unknown key "dt"; it belongs under motion'),
        ("scnee: 3", 'exp.yaml:3:1: unknown key "scnee"; did you mean "scene"?'),
        ("title: again", 'exp.yaml:3:1: duplicate key "title"; the first is in line 1'),
        ("question: 5", "exp.yaml:3:11: question must be text, not 5"),
    ],
)
def test_a_wrong_value_elsewhere_is_named_at_its_place(more: str, problem: str, problems_in: ProblemsIn) -> None:
    assert said(SPHERES + more, problems_in).startswith(problem)


def test_a_title_is_required_and_is_text(problems_in: ProblemsIn) -> None:
    scene = "scene: {shape: sphere, count: 2, box: [1, 1, 1]}\n"
    assert problems_in(scene) == ['exp.yaml:1:1: "title" is missing']
    assert problems_in("title: 5\n" + scene)[0].startswith("exp.yaml:1:8: title must be text, not 5")
    assert problems_in("title: ''\n" + scene) == ["exp.yaml:1:8: title must not be empty"]


@pytest.mark.parametrize(
    ("scene", "problem"),
    [
        ("{shape: sphere, count: 2}", "exp.yaml:2:1: a scene needs box"),
        ("{shape: sphere, box_ratio: 1}", "exp.yaml:2:1: a scene needs count"),
        ("{count: 2, box_ratio: 1}", "exp.yaml:2:1: shape mesh needs a mesh; only shape sphere does without"),
        ("{shape: sphere, count: 2, box_ratio: 1, box: [1, 1, 1]}", "exp.yaml:2:53: box and box_ratio exclude"),
        ("{shape: sphere, count: 2, box_ratio: 1, bodies: [{position: [0, 0, 0]}]}", "exp.yaml:2:31: count and bodies"),
        ("{shape: sphere, box_ratio: 1, bodies: []}", "exp.yaml:2:46: bodies must not be empty"),
        ("{shape: sphere, box_ratio: 1, bodies: [{}]}", 'exp.yaml:2:47: "position" is missing'),
        ("{shape: sphere, box_ratio: 1, bodies: [{position: [0, 0]}]}", "exp.yaml:2:58: position must hold 3 numbers"),
        ("{shape: sphere, box_ratio: 1, bodies: [{position: [0, 0, 0], mas: 2}]}", 'unknown key "mas"; did you mean "'),
        ("{shape: sphere, box_ratio: 1, bodies: [{position: [0,0,0], orientation: [0,0,0,0]}]}", "a rotation"),
    ],
)
def test_a_scene_has_bodies_and_a_box_and_a_mesh_unless_it_is_of_spheres(
    scene: str, problem: str, problems_in: ProblemsIn
) -> None:
    assert problem in said(f"title: t\nscene: {scene}", problems_in)


def test_extreme_scenes_are_not_refused(read: Read) -> None:
    for count, size, speed, box in ((0, 1, 0, 1), (10**9, 1e-6, 1e-12, 1e9), ("1e5", 1e6, 1e12, 1e-3)):
        assert read(SPHERES, count=count, size=size, speed=speed, box=[box] * 3, duration=1e9).points


def test_dt_may_exceed_the_duration(read: Read) -> None:
    experiment = read(SPHERES + "motion: {dt: 3, duration: 1}")
    assert experiment.points[0].motion.frames == 0


def test_frames_are_counted_as_the_contract_says() -> None:
    assert MotionSpec().frames == 600
    assert MotionSpec(duration=1, dt=1 / 3).frames == 3


def test_memory_is_read_in_units() -> None:
    for text, size in (("4GiB", 2**32), ("512 MiB", 2**29), ("2GB", 2 * 10**9), ("1.5 kib", 1536), (1000, 1000)):
        assert MeasureSpec(memory=text).memory == size  # type: ignore[arg-type]


def test_distributions_draw_what_they_say() -> None:
    rng = np.random.default_rng(1)
    uniform = Distribution.model_validate({"uniform": [1, 3]})
    choice = Distribution.model_validate({"choice": [1, 5, 6]})
    assert (uniform.kind, uniform.values, uniform.mean) == ("uniform", (1.0, 3.0), 2.0)
    assert (choice.kind, choice.values, choice.mean) == ("choice", (1.0, 5.0, 6.0), 4.0)
    assert Distribution(2.0).sample(rng, 3).tolist() == [2.0, 2.0, 2.0]
    assert set(choice.sample(rng, 100)) == {1.0, 5.0, 6.0}
    drawn = uniform.sample(rng, 1000)
    assert drawn.shape == (1000,)
    assert 1 <= drawn.min() < 1.1
    assert 2.9 < drawn.max() < 3
    assert uniform.model_dump(mode="json") == {"uniform": [1.0, 3.0]}
    assert Distribution(2.0).model_dump(mode="json") == 2.0


def test_models_made_in_python_meet_the_same_rules() -> None:
    with pytest.raises(ValidationError, match="exclude each other"):
        SceneSpec(shape="sphere", count=1, box_ratio=1, box=(1, 1, 1))
    with pytest.raises(ValidationError, match="no algorithm grid"):
        EngineSpec(backend="coal", algorithm="grid")
    assert BodySpec(position=(0, 0, 0)).orientation == (1, 0, 0, 0)


def test_nothing_can_be_changed_afterwards() -> None:
    scene = SceneSpec(shape="sphere", count=1, box_ratio=1)
    with pytest.raises(ValidationError):
        scene.count = 2


@pytest.mark.parametrize(
    ("row", "text"),
    [
        ("metric: a, at_most: 1.0e-12", "a is at most 1e-12"),
        ("metric: a, at_least: 3", "a is at least 3"),
        ("metric: a, equals: 0", "a is 0"),
        ("metric: a, between: [1, 2]", "a is between 1 and 2"),
        ("metric: a, within: {of: 2, relative: 0.003}", "a is within 0.3 % of 2"),
        (
            "metric: a, where: {count: 1e3, algorithm: grid}, equals: 1",
            "a where count is 1000 and algorithm is grid is 1",
        ),
        ("metric: a, exponent_of: faces, between: [1.8, 2.2]", "a grows with faces to a power between 1.8 and 2.2"),
        (
            "metric: a, ratio_to: {algorithm: grid}, at_most: .5",
            "a, divided by that where algorithm is grid, is at most 0.5",
        ),
    ],
)
def test_a_criterion_can_be_said_in_words(row: str, text: str, read: Read) -> None:
    (criterion,) = read(f"{SPHERES}claims: [{{{row}}}]").claims
    assert criterion.text == text
    assert Criterion.model_validate(criterion.model_dump(mode="json", exclude_none=True)) == criterion


@pytest.mark.parametrize(
    ("row", "problem"),
    [
        ("metric: a", "a row of expect needs exactly one of at_most"),
        ("metric: a, at_most: 1, equals: 1", "at_most and equals are too many"),
        ("metric: a, exponent_of: count, at_most: 1", "needs between: [low, high], not at_most"),
        ("metric: a, exponent_of: shape, between: [1, 2]", "shape is not a number that anything could grow with"),
        ("metric: a, ratio_to: {count: 5}, within: {of: 1, relative: 0}", "ratio_to needs one of at_most, at_least, "),
        ("metric: a, ratio_to: {}, at_most: 1", "ratio_to must name the leaf values"),
        ("metric: a, between: [2, 1]", "between must rise from low to high"),
        ("metric: a, where: {cuont: 5}, equals: 1", 'unknown leaf "cuont"; did you mean "count"?'),
        ("metric: a, where: {algorithm: gird}, equals: 1", "algorithm must be brute-force, "),
        ("metric: a, where: {faces: many}, equals: 1", "faces must be a number, not many"),
        ("metric: 5, equals: 1", "metric must be text, not 5"),
        ("at_most: 1", '"metric" is missing'),
        ("metric: a, at_mots: 1, equals: 1", 'unknown key "at_mots"; did you mean "at_most"?'),
        ("metric: a, equals: .nan", "equals must be a finite number, not nan"),
    ],
)
def test_a_wrong_criterion_says_why(row: str, problem: str, problems_in: ProblemsIn) -> None:
    message = said(f"{SPHERES}expect:\n- {{{row}}}", problems_in)
    assert problem in message
    assert message.startswith("exp.yaml:4:")


def test_criteria_hold_leaf_values_as_results_do(read: Read) -> None:
    row = "{metric: a, where: {dt: 1/60, size: {choice: [1, 2]}, box: [1, 2, 3]}, equals: 0}"
    (criterion,) = read(f"{SPHERES}expect: [{row}]").expect
    assert criterion.where == {"dt": 1 / 60, "size": {"choice": [1.0, 2.0]}, "box": [1.0, 2.0, 3.0]}


PASSING = SPHERES + "motion: {response: none}\n"


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        (
            PASSING + "engine: {query: tolerance}",
            "exp.yaml:4:17: query tolerance needs within, the gap up to which pairs are asked about (m)",
        ),
        (
            PASSING + "engine: {within: 0.1}",
            "exp.yaml:4:18: within would have no effect with query collision, only with tolerance or distance",
        ),
        (
            PASSING + "engine: {algorithm: predictive}\nsweep: {query: [collision, impact]}",
            "exp.yaml:5:28: algorithm predictive cannot be asked query impact, only collision; leave it out with "
            "`exclude: - {algorithm: predictive, query: impact}`",
        ),
        (
            SPHERES + "engine: {query: impact}",
            "exp.yaml:3:17: query impact needs response none, for only pairs that touch can be answered; response is "
            "reflect",
        ),
        (
            PASSING + "engine: {query: colision}",
            "exp.yaml:4:17: query must be collision, tolerance, distance or impact",
        ),
    ],
)
def test_a_query_that_cannot_be_is_refused(text: str, problem: str, problems_in: ProblemsIn) -> None:
    assert any(found.startswith(problem) for found in problems_in(text)), problems_in(text)
