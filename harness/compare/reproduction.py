"""A real disagreement as an experiment file, which `harness compare` finds again by itself."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from harness.compare.outcome import Case
from harness.vocabulary import MethodName
from harness.whole_file import write_whole


def save(case: Case, folder: Path, name: str, mesh: Path | None, script: str | None = None) -> Path:
    """Write a case whose bodies are at rest at their poses.

    Parameters
    ----------
    case : Case
    folder : made if it is not there
    name : of the file, without suffix
    mesh : the file of its mesh, which is copied beside the experiment
    script : a Python file that shows the same without this program, written beside it

    Returns
    -------
    Path
        Of the experiment.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if mesh is not None and not (folder / mesh.name).exists():
        shutil.copyfile(mesh, folder / mesh.name)
    path = folder / f"{name}.yaml"
    if script is not None:
        write_whole(path.with_suffix(".py"), script)
    write_whole(path, text_of(case, mesh.name if mesh else None))
    return path


def text_of(case: Case, mesh: str | None) -> str:
    """The experiment: its bodies rest, so that `harness compare` asks of this pose alone and `harness view` shows it.

    Parameters
    ----------
    case : Case
    mesh : name of a mesh file that will lie beside the experiment
    """
    scene, (i, j) = case.scene, case.bodies
    methods = [MethodName.read(name, scene.shape) for name in case.backends]
    leaves = {leaf: [getattr(method, leaf) for method in methods] for leaf in ("backend", "algorithm")}
    rows = zip(
        scene.bodies.positions.tolist(), scene.bodies.quaternions.tolist(), scene.bodies.sizes.tolist(), strict=True
    )
    bodies = [{"position": at, "velocity": [0, 0, 0], "orientation": turned, "size": size} for at, turned, size in rows]
    declared = {"shape": scene.shape, "box": scene.box.sides.tolist(), "bodies": bodies}
    if mesh is not None and scene.shape != "sphere":
        declared["mesh"] = mesh
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
