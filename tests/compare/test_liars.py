"""Every liar is caught and named, and the honest backends beside it are not accused."""

import numpy as np
import pytest

from harness.compare.comparison import compare
from harness.compare.hard_poses import hard_poses
from harness.compare.outcome import LOADING
from harness.compare.poses import Pose, PoseSet, flown
from tests.compare.liars import BY_CHANGE, BY_CLAIM, BY_CONTRACT, LIARS, install
from tests.conftest import cube_mesh, needs_pybullet, random_scene

# Left out of the quick tests, which keep one or two of each kind.
SLOW = (
    *("drops-at-random", "random-verdicts", "drops-neighbours", "last-frame", "halves-hulls", "inflates-by-1e-3"),
    *("spheres-for-all", "sees-all", "doubles", "unsorted", "turned-round", "out-of-range"),
    *("floats", "tolerates-nan", "raises", "blind", "hulls-inside-out", "hulls-of-nobody", "tolerates-by-lot"),
    *("learns", "halves-without-faces"),
)


# Named when they load or at their first hits, so that few poses do.
AT_ONCE = ("blind", "sees-all", "tolerates-by-lot", *BY_CONTRACT, *BY_CLAIM)


def marked(names):
    return [pytest.param(name, marks=pytest.mark.slow if name in SLOW else ()) for name in names]


@pytest.fixture
def liar(tmp_path, monkeypatch):
    return lambda name: install(name, tmp_path / "plugins", monkeypatch)


def crowd(frames=24):
    """Frames in which many bodies of more than one neighbour touch."""
    return flown(random_scene("hull", 16, 2.6, seed=4), frames, 1 / 60)


@pytest.fixture(scope="module")
def judged(tmp_path_factory):
    """What comes of a liar among honest backends, asked once; at few poses where nearly all it says is wrong."""
    known = {}

    def found(name):
        if name not in known:
            with pytest.MonkeyPatch.context() as patch:
                names = ["fcl", install(name, tmp_path_factory.mktemp("plugins"), patch), "pybullet"]
                frames = 4 if name in AT_ONCE else 24
                known[name] = compare([crowd(frames)], names, timeout=5.0)
        return known[name]

    return found


def named(found):
    """Who was found wrong, or failed."""
    return {case.wrong for case in found.cases + found.shared} | {failure.backend for failure in found.failures}


@needs_pybullet
@pytest.mark.parametrize("name", marked(name for name in LIARS if name not in ("sleeps", "caches")))
def test_a_liar_is_caught_and_nobody_else_is_accused(name, judged):
    found = judged(name)
    assert named(found) == {name}
    assert not found.passed


@pytest.mark.slow
def test_one_that_takes_near_poses_for_the_same_is_caught_at_the_small_steps(liar):
    pose_set = next(iter(hard_poses("hull", (cube_mesh(),))))
    found = compare([pose_set], ["fcl", liar("caches")])
    assert named(found) == {"caches"}


@pytest.mark.slow
def test_one_that_does_not_answer_is_given_up_and_named(liar):
    said = []
    found = compare([crowd()] * 3, ["fcl", liar("sleeps")], said.append, timeout=0.3)
    assert named(found) == {"sleeps"}
    assert "from frame 4 on it is not asked" in found.unsupported[0]
    assert "at 5 poses of a scene, and is not asked about other scenes" in found.unsupported[1]
    assert (len(found.failures), len(said)) == (5, 1)


@needs_pybullet
@pytest.mark.parametrize("name", marked(BY_CONTRACT))
def test_a_breach_of_the_contract_names_the_backend(name, judged):
    reasons = {failure.reason for failure in judged(name).failures}
    told = "read-only" if name == "writes-poses" else f'backend "{name}"'
    assert reasons
    assert all(told in reason for reason in reasons)


@needs_pybullet
@pytest.mark.parametrize("name", marked(BY_CLAIM))
def test_what_a_backend_claims_is_bounded(name, judged):
    assert [failure.kind for failure in judged(name).failures if failure.pose == LOADING] == ["claim"]


@pytest.mark.slow
def test_a_tolerance_that_changes_is_none(judged):
    failure = next(one for one in judged("tolerates-by-lot").failures if one.pose == LOADING)
    assert failure.reason == "it declares a tolerance of 1e-15 one time and of 0.001 another, of the same shape"


@pytest.mark.parametrize("name", marked(BY_CHANGE))
def test_a_verdict_that_changes_is_called_what_it_is(name, judged):
    failures = judged(name).failures
    assert BY_CHANGE[name] in {failure.kind for failure in failures}
    assert all(len(failure.bodies) == 2 for failure in failures)


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["sphere", "hull"])
def test_honest_backends_are_not_accused(shape):
    sets = [flown(random_scene(shape, 16, 2.6, seed=4), 24, 1 / 60), *hard_poses(shape, (cube_mesh(),), 5)]
    found = compare(sets, ["fcl", "fcl/grid", "pybullet"])
    wrong = [(case.wrong, case.pose.name, case.judgement.gap) for case in found.cases + found.shared]
    assert (wrong, found.failures) == ([], [])


def test_a_contact_that_is_over_is_none():
    """A cube flies through another along z: they touch while their centres are at most 1.1547005 m apart."""
    from harness.backends import registry
    from harness.scene.box import Box
    from harness.scene.scene import Scene
    from tests.conftest import make_bodies

    bodies = make_bodies([[0, 0, 0], [0.01, 0.02, 4]], [[0, 0, 0], [0, 0, -1]], sizes=[3, 1])
    scene = Scene("hull", (cube_mesh(),), bodies, Box(np.full(3, 60.0)))
    backend = registry.create("pybullet")
    backend.load(scene)
    poses = flown(scene, 800, 0.01).poses(scene)[1:]
    touching = [len(backend.pairs(pose.positions, pose.quaternions)) for pose in poses]
    assert sum(touching) in (230, 231)
    for pose, hit in zip(poses, touching, strict=True):
        apart = abs(float(pose.positions[1, 2] - pose.positions[0, 2]))
        assert hit == (apart <= 2 / np.sqrt(3)) or abs(apart - 2 / np.sqrt(3)) < 1e-3


@pytest.mark.slow
def test_each_method_is_asked_once_a_pose_and_once_more_in_another_order(liar, tmp_path):
    scene = random_scene("sphere", 4, 3.0)
    asked = []

    def poses(held):
        asked.append(1)
        return tuple(Pose(f"{k}", scene.bodies.positions + k, scene.bodies.quaternions) for k in range(5))

    found = compare([PoseSet(scene, poses)], ["fcl", "fcl/grid", "pybullet"])
    assert len(asked) == 1  # one group, since spheres have no hulls
    assert [tally.poses for tally in found.tallies] == [5, 5, 5]
