"""Writes the reproductions of the published accusations anew, without asking the atlas again.

    python -m tests.compare.reproductions

Of each engine, family and shape the farthest wrong verdict gets a file, or the farthest of which there is one that
shows it here. Every library that is accused has to be installed.
"""

import json
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

import numpy as np

from harness.compare.atlas import JUDGE
from harness.compare.judge import judge
from harness.compare.library_calls import CALLS
from harness.compare.outcome import Case
from harness.compare.placing import two_bodies
from harness.compare.poses import Pose
from harness.compare.script import script_of
from harness.experiment.load import load
from harness.scene.mesh_child import open_all
from tests.compare.recheck import PUBLISHED

WHOLE = Path(__file__).parents[2] / "experiments/atlas/whole.yaml"


def case_of(row, meshes):
    """The accusation, about bodies as the engine was given them."""
    sizes = tuple(body["size"] for body in row["bodies"])
    positions, quaternions = (np.array([body[name] for body in row["bodies"]]) for name in ("position", "quaternion"))
    scene = two_bodies(row["shape"], (meshes[row["mesh"]],) if row["mesh"] else (), sizes, 0.0)
    scene = replace(scene, bodies=replace(scene.bodies, positions=positions, quaternions=quaternions))
    truth = judge(scene, 0, 1, positions, quaternions)
    pose = Pose("at rest", positions, quaternions)
    return Case((row["engine"], JUDGE), row["engine"], (0, 1), truth, scene=scene, pose=pose, query_index=1)


def farthest_first(row):
    return -abs(row["gap"]) / min(body["size"] for body in row["bodies"])


def written(rows, meshes, folder):
    """Write the files and name them in the rows; the rows of which none has a file."""
    groups = {}
    for row in rows:
        groups.setdefault((row["engine"], row["family"], row["shape"]), []).append(row)
    without = []
    for name, group in groups.items():
        for row in group:
            row["file"] = ""
        for row in sorted(group, key=farthest_first):
            text = script_of(case_of(row, meshes))
            if text is not None:
                row["file"] = f"{folder.name}/{'-'.join(name)}.py"
                (folder.parent / row["file"]).write_text(text)
                row["library"] = CALLS[row["engine"], row["shape"]].library
                row["version"] = version(row["library"])
                break
        else:
            without.append(name)
    return without


if __name__ == "__main__":
    opened = open_all(load(WHOLE).mesh_paths.values())
    rows = json.loads(PUBLISHED.read_text())
    folder = PUBLISHED.parent / "reproductions"
    for old in folder.glob("*.py"):
        old.unlink()
    without = written(rows, {path.name: mesh for path, mesh in opened.items()}, folder)
    PUBLISHED.write_text("[\n" + ",\n".join(map(json.dumps, rows)) + "\n]\n")
    print(f"{len(list(folder.glob('*.py')))} files; none of {without or 'nothing'}")
