import numpy as np
import pytest
import trimesh

from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.mesh_file import make_mesh
from harness.scene.scene import Scene
from harness.vocabulary import WALLS


def bodies(sizes):
    count = len(sizes)
    return Bodies(
        positions=np.zeros((count, 3)),
        velocities=np.zeros((count, 3)),
        quaternions=np.tile([1.0, 0, 0, 0], (count, 1)),
        spins=np.zeros((count, 3)),
        sizes=np.array(sizes, float),
        masses=np.ones(count),
    )


def test_packing_is_of_bounding_spheres_and_the_side_of_the_cube_of_the_same_volume():
    scene = Scene("sphere", (), bodies([1, 2]), Box(np.array([1, 2, 4])))
    assert scene.packing == pytest.approx(np.pi / 6 * 9 / 64)
    assert scene.box_side == pytest.approx(4)
    assert scene.mean_size == 1.5
    assert (scene.faces, scene.hull_vertices) == (0, 0)


def test_faces_and_hull_are_the_meshes():
    cube = trimesh.creation.box().subdivide()
    scene = Scene("hull", (make_mesh("cube", cube.vertices, cube.faces),), bodies([]), Box(np.ones(3)))
    assert (scene.faces, scene.hull_vertices, scene.packing, scene.mean_size) == (48, 8, 0, 0)


def test_only_spheres_need_no_mesh():
    with pytest.raises(ValueError, match="needs a mesh"):
        Scene("hull", (), bodies([1]), Box(np.ones(3)))


def test_a_copy_of_bodies_shares_nothing():
    one = bodies([1, 2])
    two = one.copy()
    two.positions += 1
    two.sizes *= 2
    assert len(two) == 2
    assert (one.positions == 0).all()
    assert one.radii.tolist() == [0.5, 1]


def test_bodies_of_unequal_arrays_are_refused():
    with pytest.raises(ValueError, match="quaternions of 1 bodies"):
        Bodies(*(np.zeros((1, 3)) for _ in range(4)), np.ones(1), np.ones(1))


def test_a_box_has_six_walls_and_positive_sides():
    assert len(WALLS) == 6
    assert Box(np.array([1, 2, 3])).volume == 48
    for half in ([1, 1, 0], [1, 1, np.nan], [1, 1]):
        with pytest.raises(ValueError, match="half sides"):
            Box(np.array(half))
