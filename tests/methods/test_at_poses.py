"""A method of this program, asked at poses as a backend is."""

from dataclasses import replace

import numpy as np
import pytest

from harness.backends import registry
from harness.errors import InputError
from harness.methods.at_poses import AtPoses
from harness.scene.hull import convex_hull
from harness.scene.scene import Scene
from harness.vocabulary import MethodName
from tests.conftest import random_scene
from tests.narrowphase.meshes import mesh_named


def pairs(asked, scene):
    asked.load(scene)
    return asked.pairs(scene.bodies.positions, scene.bodies.quaternions).tolist()


@pytest.mark.parametrize("algorithm", ["brute-force", "grid", "sap", "tree"])
@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
def test_it_gives_the_verdicts_of_the_backend(algorithm, shape):
    scene = random_scene(shape, 30, 2.5, seed=3)
    method = AtPoses(MethodName("fcl", algorithm, shape))
    assert method.name == f"fcl/{algorithm}"
    assert pairs(method, scene) == pairs(registry.create("fcl"), scene)


@pytest.mark.parametrize("algorithm", ["grid", "sap", "tree"])
def test_it_judges_the_hulls_it_is_given_also_where_they_stick_out_of_the_bounding_spheres(algorithm):
    crowd = random_scene("hull", 40, 2.6, seed=1)
    mesh = mesh_named("pumpkin-1753.ply")
    larger = convex_hull(mesh.hull.vertices * 1.2)
    scene = Scene("hull", (mesh,), replace(crowd.bodies, sizes=np.ones(40)), crowd.box, hulls={(0, 1.0): larger})
    found = pairs(AtPoses(MethodName("fcl", algorithm, "hull")), scene)
    assert found == pairs(registry.create("fcl"), scene)
    assert len(found) > len(pairs(registry.create("fcl"), replace(scene, hulls={})))


def test_a_method_that_computes_events_has_no_verdict_on_a_pose():
    with pytest.raises(InputError, match="computes events"):
        AtPoses(MethodName("fcl", "predictive", "sphere"))
