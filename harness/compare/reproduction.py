"""A real disagreement as an experiment file, which `harness compare` finds again by itself."""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import count
from pathlib import Path

from harness.compare.outcome import Case
from harness.compare.poses import Frame
from harness.compare.question import Question
from harness.vocabulary import NEAR_QUERIES, MethodName
from harness.whole_file import write_whole


def save(case: Case, folder: Path, name: str, meshes: Sequence[Path], script: str | None = None) -> Path:
    """Write a case whose bodies are alone: at rest at their poses, or moving through one frame.

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

    Raises
    ------
    OSError
        If a file cannot be written; no half of one is left.
    """
    folder.mkdir(parents=True, exist_ok=True)
    names = [mesh.name for mesh in meshes]
    for number in sorted(set(case.scene.mesh_of.tolist())) if meshes else ():
        names[number] = _copied(meshes[number], folder)
    path = folder / f"{name}.yaml"
    if script is not None:
        write_whole(path.with_suffix(".py"), script)
    write_whole(path, text_of(case, names))
    return path


def _copied(mesh: Path, folder: Path) -> str:
    """The name of a copy in a folder, where another mesh may have that name already: links of two robots, say."""
    content = mesh.read_bytes()
    names = (mesh.name if number == 1 else f"{mesh.stem}-{number}{mesh.suffix}" for number in count(1))
    copy = next(path for path in map(folder.joinpath, names) if not path.exists() or path.read_bytes() == content)
    if not copy.exists():
        write_whole(copy, content)
    return copy.name


def text_of(case: Case, meshes: Sequence[str]) -> str:
    """The experiment: `harness compare` asks the same of this pose, or this frame, alone, and `harness view` shows it.

    Parameters
    ----------
    case : Case
    meshes : names of the files of its meshes, which will lie beside the experiment
    """
    scene, (i, j), asked = case.scene, case.bodies, case.question
    methods = [MethodName.read(name, scene.shape, asked.query) for name in case.backends]
    leaves = {leaf: [getattr(method, leaf) for method in methods] for leaf in ("backend", "algorithm")}
    bodies = _rows(case)
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
    motion: dict[str, object] = {"duration": 0, "response": "none"}
    if isinstance(case.pose, Frame):
        motion = {"duration": case.pose.duration, "dt": case.pose.duration, "response": "none"}
    lines = {
        "title": f"{case.wrong} {verb} wrong about bodies {i} and {j}",
        "question": question_of(case),
        "scene": declared,
        "motion": motion,
        **({} if asked.query == "collision" else {"engine": _engine(asked)}),
        "zip": [leaves],
        "measure": {"repeats": 1},
    }
    head = "# `harness compare` on this file finds it again; `harness view` shows it.\n"
    return head + "".join(f"{key}: {json.dumps(value)}\n" for key, value in lines.items())


def _rows(case: Case) -> list[dict[str, object]]:
    bodies = case.scene.bodies
    rows = zip(
        bodies.positions.tolist(),
        bodies.velocities.tolist(),
        bodies.quaternions.tolist(),
        bodies.spins.tolist(),
        bodies.sizes.tolist(),
        strict=True,
    )
    moving = isinstance(case.pose, Frame)
    return [
        {"position": at, "velocity": way if moving else [0, 0, 0], "orientation": turned}
        | ({"spin": spin} if moving else {})
        | {"size": size}
        for at, way, turned, spin, size in rows
    ]


def _engine(asked: Question) -> dict[str, object]:
    within = {"within": asked.within} if asked.query in NEAR_QUERIES else {}
    return {"query": asked.query, **within, "tolerance": asked.tolerance}


def question_of(case: Case) -> str:
    """What is asked, and what is true of it."""
    truth, asked = case.judgement, case.question
    state = "overlap" if truth.touching else "do not touch"
    if asked.query == "collision":
        return f"Do they touch? Exactly, they {state}; their gap is {truth.gap:.6g} m."
    if asked.query == "impact":
        there = f"Exactly, they {state} at {case.moment:.9g} s; their gap is {truth.gap:.6g} m."
        return f"When do they begin to touch? {there}"
    asks = "How far apart are they?" if asked.query == "distance" else f"Are they within {asked.within:g} m?"
    return f"{asks} Exactly, their gap is {truth.gap:.17g} m."
