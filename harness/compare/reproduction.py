"""A real disagreement as an experiment file, which `harness compare` finds again by itself."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from harness.compare.comparison import Case


def save(case: Case, folder: Path, number: int, mesh: Path | None) -> Path:
    """Write a case whose bodies are at rest at their poses.

    Parameters
    ----------
    case : Case
    folder : made if it is not there
    number : tells it from other cases of the same backends
    mesh : the file of its mesh, which is copied beside the experiment

    Returns
    -------
    Path
        Of the experiment.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if mesh is not None and not (folder / mesh.name).exists():
        shutil.copyfile(mesh, folder / mesh.name)
    scene, (i, j) = case.scene, case.bodies
    algorithms = ["brute-force" if name == "fcl" else "native" for name in case.backends]
    rows = zip(
        scene.bodies.positions.tolist(), scene.bodies.quaternions.tolist(), scene.bodies.sizes.tolist(), strict=True
    )
    bodies = [{"position": at, "orientation": turned, "size": size} for at, turned, size in rows]
    declared = {"shape": scene.shape, "box": scene.box.sides.tolist(), "bodies": bodies}
    if mesh is not None and scene.shape != "sphere":
        declared["mesh"] = mesh.name
    state = "overlap" if case.judgement.touching else "do not touch"
    lines = {
        "title": f"{case.wrong} is wrong about bodies {i} and {j}",
        "question": f"Do they touch? Exactly, they {state}; their gap is {case.judgement.gap:.6g} m.",
        "scene": declared,
        "motion": {"duration": 0, "response": "none"},
        "zip": [{"backend": list(case.backends), "algorithm": algorithms}],
        "measure": {"repeats": 1},
    }
    path = folder / f"{'-'.join(case.backends)}-{number}.yaml"
    path.write_text("".join(f"{key}: {json.dumps(value)}\n" for key, value in lines.items()), encoding="utf-8")
    return path
