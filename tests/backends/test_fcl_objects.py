"""Bodies as FCL objects."""

from dataclasses import replace

from harness.backends.fcl_objects import FclObjects
from tests.conftest import random_scene


def test_a_mesh_is_given_to_fcl_once_for_all_scenes_of_it_but_hulls_of_a_library_are_their_own():
    scene = random_scene("hull", 3, 4.0)
    first, again = FclObjects(scene).geometries, FclObjects(replace(scene)).geometries
    assert first[0] is again[0]
    assert FclObjects(replace(scene, shape="mesh")).geometries[0] is not first[0]
    held = {(0, float(scene.bodies.sizes[0])): scene.meshes[0].hull}
    assert FclObjects(replace(scene, hulls=held)).geometries[0] is not first[0]
