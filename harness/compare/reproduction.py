"""A real disagreement as an experiment file, which `harness compare` finds again by itself."""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from pathlib import Path

from harness.compare.outcome import Case
from harness.vocabulary import MethodName
from harness.whole_file import write_whole


def save(case: Case, folder: Path, name: str, meshes: Sequence[Path], script: str | None = None) -> Path:
    """Write a case whose bodies are at rest at their poses.

    Parameters
    ----------
    case : Case
    folder : made if it is not there
    name : of the file, without suffix
    meshes : the files of its meshes, those that its bodies have of which are copied beside the experiment
    script : a Python file that shows the same without this program, written beside it

    Returns
    -------
    Path
        Of the experiment.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for number in set(case.scene.mesh_of.tolist()) if meshes else ():
        if not (folder / meshes[number].name).exists():
            shutil.copyfile(meshes[number], folder / meshes[number].name)
    path = folder / f"{name}.yaml"
    if script is not None:
        write_whole(path.with_suffix(".py"), script)
    write_whole(path, text_of(case, [mesh.name for mesh in meshes]))
    return path


def text_of(case: Case, meshes: Sequence[str]) -> str:
    """The experiment: its bodies rest, so that `harness compare` asks of this pose alone and `harness view` shows it.

    Parameters
    ----------
    case : Case
    meshes : names of the files of its meshes, which will lie beside the experiment
    """
    scene, (i, j) = case.scene, case.bodies
    methods = [MethodName.read(name, scene.shape) for name in case.backends]
    leaves = {leaf: [getattr(method, leaf) for method in methods] for leaf in ("backend", "algorithm")}
    rows = zip(
        scene.bodies.positions.tolist(), scene.bodies.quaternions.tolist(), scene.bodies.sizes.tolist(), strict=True
    )
    bodies: list[dict[str, object]] = [
        {"position": at, "velocity": [0, 0, 0], "orientation": turned, "size": size} for at, turned, size in rows
    ]
    declared = {"shape": scene.shape, "box": scene.box.sides.tolist(), "bodies": bodies}
    if len(scene.ignored):
        declared["ignore"] = scene.ignored.tolist()
    if meshes and scene.shape != "sphere":
        named = [meshes[number] for number in scene.mesh_of.tolist()]
        if len(set(named)) == 1:
            declared["mesh"] = named[0]
        else:
            bodies[:] = [{"mesh": name, **body} for name, body in zip(named, bodies, strict=True)]
    verb = "are" if case.both_wrong else "is"
    state = "overlap" if case.judgement.touching else "do not touch"
    lines = {
        "title": f"{case.wrong} {verb} wrong about bodies {i} and {j}",
        "question": f"Do they touch? Exactly, they {state}; their gap is {case.judgement.gap:.6g} m.",
        "scene": declared,
        "motion": {"duration": 0, "response": "none"},
        "zip": [leaves],
        "measure": {"repeats": 1},
    }
    head = "# `harness compare` on this file finds it again; `harness view` shows it.\n"
    return head + "".join(f"{key}: {json.dumps(value)}\n" for key, value in lines.items())
