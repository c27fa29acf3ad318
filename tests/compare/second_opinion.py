"""The judge of meshes against CGAL on hard poses, whose differences exact arithmetic decides.

    python -m tests.compare.second_opinion COUNT

CGAL is told of vertices in the world, rounded to doubles, and the judge of poses. So they may differ where rounding
turns a verdict; of each such pose the judge is asked anew, about the rounded vertices as they stand, and must then say
what CGAL says.
"""

import sys
from pathlib import Path

import igl.copyleft.cgal
import numpy as np

from harness.compare.families import family_poses
from harness.compare.judge import judge
from harness.compare.surfaces import judge_surfaces
from harness.scene.mesh import Surface
from harness.scene.mesh_file import read_mesh
from harness.vocabulary import FAMILIES
from tests.conftest import cube_mesh

ATLAS = Path(__file__).parents[2] / "experiments/atlas"
MESHES = {
    "cube": cube_mesh,
    "needle": lambda: read_mesh(ATLAS / "needle.off"),
    "plate": lambda: read_mesh(ATLAS / "plate.off"),
}
UPRIGHT, ORIGIN = np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3)
# Those whose poses are drawn, and not recorded.
DRAWN = tuple(family for family in FAMILIES if family != "resting")


def placed(solid, position, quaternion):
    """The vertices of a body in the world, in doubles."""
    w, x, y, z = quaternion
    turn = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip
    return Surface(solid.vertices @ turn.T + position, solid.faces)


def intersect(first, second):
    faces = (np.asarray(surface.faces, np.int64) for surface in (first, second))
    one, other = faces
    return bool(len(igl.copyleft.cgal.intersect_other(first.vertices, one, second.vertices, other, True, True)[0]))


def opinions(count, meshes=MESHES, families=DRAWN):
    """(poses, those at which they differ, of those the ones that rounding does not explain)."""
    asked, differ, unexplained = 0, [], []
    kinds = [(name, family) for name in meshes for family in families]
    kinds = [kind for kind in kinds if kind[0] == "cube" or kind[1] != "contained"]  # nothing is inside of what is thin
    each = -(-count // len(kinds))
    for name in meshes:
        mesh = MESHES[name]()
        for family in (family for kind, family in kinds if kind == name):
            for poses in family_poses(family, "mesh", (mesh,), each):
                sizes = poses.scene.bodies.sizes.tolist()
                for pose in poses.poses(poses.scene):
                    asked += 1
                    truth = judge(poses.scene, 0, 1, pose.positions, pose.quaternions)
                    solids = (poses.scene.solid_of(size) for size in sizes)
                    first, second = map(placed, solids, pose.positions, pose.quaternions)
                    said = intersect(first, second)
                    if said == truth.touching:
                        continue
                    differ.append((name, family, pose.name, truth.gap))
                    if judge_surfaces(first, ORIGIN, UPRIGHT, second, ORIGIN, UPRIGHT).touching != said:
                        unexplained.append(differ[-1])
    return asked, differ, unexplained


if __name__ == "__main__":
    asked, differ, unexplained = opinions(int(sys.argv[1]))
    farthest = max((abs(gap) for *_, gap in differ), default=0.0)
    print(f"{asked} poses; {len(differ)} differ, by rounding the vertices, at gaps of at most {farthest:.3g} m")
    print(f"{len(unexplained)} that exact arithmetic on the rounded vertices does not decide for the judge")
    for row in unexplained:
        print(*row)
    sys.exit(bool(unexplained))
