"""Sweeps unfold into points, and what cannot exist says how to leave it out."""

import time
from collections.abc import Callable

import pytest

from harness.experiment.experiment import Experiment

Read = Callable[..., Experiment]
ProblemsIn = Callable[..., list[str]]

BASE = "title: t\nscene: {shape: sphere, count: 2, box: [9, 9, 9]}\n"


def table(experiment, *leaves: str) -> list[tuple]:  # type: ignore[no-untyped-def, type-arg]
    return [tuple(point.parameters[leaf] for leaf in leaves) for point in experiment.points]


def test_a_sweep_is_a_product_in_file_order_with_the_first_key_slowest(read: Read) -> None:
    experiment = read(BASE + "sweep: {dt: [1/60, 1/30], count: [5, 6, 7]}")
    assert table(experiment, "dt", "count") == [(dt, count) for dt in (1 / 60, 1 / 30) for count in (5, 6, 7)]
    assert experiment.swept == ("dt", "count")
    assert experiment.runs == 30


def test_a_zip_block_varies_together(read: Read) -> None:
    experiment = read(BASE + "sweep: {seed: [1, 2]}\nzip:\n  - {count: [5, 6], size: [1, {uniform: [1, 2]}]}")
    assert table(experiment, "seed", "count", "size") == [
        (seed, *row) for seed in (1, 2) for row in ((5, 1.0), (6, {"uniform": [1.0, 2.0]}))
    ]
    assert experiment.swept == ("seed", "count", "size")


def test_excluded_points_are_left_out_and_a_list_means_any_of(read: Read) -> None:
    text = "engine: {algorithm: native}\nsweep: {backend: [pybullet, coal], count: [1, 2, 3]}\n"
    experiment = read(BASE + text + "exclude: [{backend: coal, count: [1, 3]}, {count: 2, shape: sphere}]")
    assert table(experiment, "backend", "count") == [("pybullet", 1), ("pybullet", 3)]


def test_included_points_are_whole_points_over_the_base(read: Read) -> None:
    experiment = read(BASE + "sweep: {count: [5, 6]}\ninclude: [{dt: 1/30}, {count: 9}, {count: 5}]")
    assert table(experiment, "count", "dt") == [(5, 1 / 60), (6, 1 / 60), (2, 1 / 30), (9, 1 / 60)]
    assert experiment.swept == ("count", "dt")


def test_without_anything_that_varies_included_points_are_all_there_is(read: Read) -> None:
    assert table(read(BASE + "include: [{count: 5}, {count: 6}]"), "count") == [(5,), (6,)]


def test_equal_points_are_one(read: Read) -> None:
    assert table(read(BASE + "sweep: {count: [5, 5, 5.0, 1e1, 10]}"), "count") == [(5,), (10,)]


def test_a_leaf_that_does_not_vary_is_not_swept(read: Read) -> None:
    assert read(BASE + "sweep: {count: [5], dt: [1, 2]}").swept == ("dt",)


def test_one_of_two_alternatives_in_a_sweep_takes_the_place_of_the_other(read: Read) -> None:
    experiment = read(BASE + "sweep: {box_ratio: [1/4, 1/9]}")
    assert table(experiment, "box", "box_ratio") == [(None, 1 / 4), (None, 1 / 9)]
    experiment = read(BASE + "include: [{bodies: [{position: [0, 0, 0]}]}, {count: 7}]")
    assert table(experiment, "count") == [(None,), (7,)]


def test_boxes_can_be_swept_and_excluded(read: Read) -> None:
    text = "sweep: {box: [[1, 1, 1], [2, 2, 2], [3, 3, 3]]}\nexclude: [{box: [1, 1, 1]}, {box: [[3, 3, 3]]}]"
    assert table(read(BASE + text), "box") == [([2.0, 2.0, 2.0],)]


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("sweep: {cuont: [1]}", 'exp.yaml:3:9: unknown leaf "cuont"; did you mean "count"?'),
        ("sweep: {repeats: [1]}", 'exp.yaml:3:9: "repeats" belongs to measure and cannot vary'),
        ("sweep: {faces: [1]}", 'exp.yaml:3:9: "faces" follows from the scene and cannot be set'),
        ("sweep: {count: 5}", "exp.yaml:3:16: count must be a list of values, not 5"),
        ("sweep: {count: []}", "exp.yaml:3:16: count needs at least one value"),
        ("sweep: {count: [1, x]}", 'exp.yaml:3:20: count must be a whole number, not "x"'),
        ("sweep: [count]", "exp.yaml:3:8: sweep must be a mapping of keys to values, not a list"),
        ("sweep: {size: [{uniform: [2, 1]}]}", "exp.yaml:3:26: uniform must rise"),
        ("zip: {count: [1]}", "exp.yaml:3:6: zip must be a list of rows, such as [{count: 5}], not a mapping"),
        ("zip: [{count: [1, 2], dt: [1]}]", "lists that vary together must be of equal length; count has 2, dt has 1"),
        ("sweep: {count: [1]}\nzip: [{count: [1]}]", "exp.yaml:4:8: count varies already"),
        ("zip: [{count: [1, 2]}, {count: [1]}]", "exp.yaml:3:25: count varies already"),
        ("sweep: {count: [1, 2]}\nexclude: [{count: 3}]", "exp.yaml:4:11: this row excludes nothing: count is never 3"),
        ("sweep: {count: [1, 2]}\nexclude: [{count: [1, 2]}]", "exp.yaml:4:1: every point is excluded"),
        ("sweep: {count: [1, 2]}\nexclude: [{dt: 5}]", "exp.yaml:4:11: this row excludes nothing: dt is never 5"),
        ("zip: [{count: [1, 2], seed: [3, 4]}]\nexclude: [{count: 1, seed: 4}]", "no point has all of these values"),
        ("sweep: {count: [1, 2]}\nexclude: [{}]", "exp.yaml:4:11: an empty row would exclude every point"),
        ("include: [{cuont: 5}]", 'exp.yaml:3:12: unknown leaf "cuont"; did you mean "count"?'),
        ("include: [{count: -5}]", "exp.yaml:3:19: count must be at least 0, not -5"),
        ("include: [{shape: hull}]", "exp.yaml:3:19: shape hull needs a mesh"),
    ],
)
def test_a_wrong_sweep_says_where(text: str, problem: str, problems_in: ProblemsIn) -> None:
    (message,) = problems_in(BASE + text)
    assert problem in message


def test_impossible_combinations_name_the_row_that_leaves_them_out_once_a_kind(
    read: Read, problems_in: ProblemsIn
) -> None:
    text = BASE + "sweep:\n  count: [1, 2, 3]\n  backend: [fcl, pybullet]\n  algorithm: [brute-force, grid, native]\n"
    rows = ["{backend: pybullet, algorithm: [brute-force, grid]}", "{backend: fcl, algorithm: native}"]
    messages = problems_in(text)
    assert messages[0].startswith("exp.yaml:6:15: backend pybullet has no algorithm brute-force or grid, only native")
    assert [message.split("`")[1] for message in messages] == [f"exclude: - {row}" for row in rows]
    mended = read(text + "exclude:\n" + "".join(f"  - {row}\n" for row in rows))
    assert len(mended.points) == 9


def test_restitution_cannot_be_swept_over_responses_without_it(problems_in: ProblemsIn) -> None:
    (message,) = problems_in(BASE + "motion: {restitution: 0.5}\nsweep: {response: [elastic, reflect]}")
    assert message.endswith("leave it out with `exclude: - {response: reflect, restitution: 0.5}`")


def test_too_many_runs_are_refused_before_any_is_made(read: Read, problems_in: ProblemsIn) -> None:
    many = f"[{', '.join(map(str, range(1000)))}]"
    start = time.perf_counter()
    (message,) = problems_in(BASE + f"sweep: {{count: {many}, seed: {many}, size: {many.replace('[0', '[1.5')}}}")
    assert time.perf_counter() - start < 2
    assert message.startswith("exp.yaml:3:1: 5000000000 runs (1000 count x 1000 seed x 1000 size, 5 repeats) are more")
    text = BASE + f"measure: {{repeats: 11}}\nsweep: {{count: {many}}}"
    assert "11000 runs" in problems_in(text)[0]
    assert len(read(text, max_runs=11_000).points) == 1000


def test_runs_are_counted_after_what_is_excluded(read: Read, problems_in: ProblemsIn) -> None:
    many = f"[{', '.join(map(str, range(1, 200)))}]"
    text = BASE + f"measure: {{repeats: 1}}\nsweep: {{count: {many}, seed: {many}}}\n"
    assert "39601 runs" in problems_in(text)[0]
    assert len(read(text + f"exclude: [{{seed: {many[:-6]}]}}]").points) == 199


def test_a_file_cannot_ask_for_more_points_than_can_be_held(problems_in: ProblemsIn) -> None:
    many = f"[{', '.join(map(str, range(1000)))}]"
    text = BASE + f"measure: {{max_runs: 1000000, repeats: 1}}\nsweep: {{count: {many}, seed: {many}}}\n"
    assert problems_in(text) == ["exp.yaml:4:1: 1000000 points are too many; there can be 100000"]
    rows = "exclude:\n" + "- {seed: 5}\n" * 100
    assert "1000000 combinations are too many to hold against 100 rows of exclude" in problems_in(text + rows)[0]
