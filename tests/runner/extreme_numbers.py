"""Experiments of extreme but legal numbers: each must end in a refusal that a person understands, or in an answer.

    python tests/runner/extreme_numbers.py [EXPERIMENTS] [SEED]

Every leaf that takes a number takes one of `NUMBERS`, far beyond any physics; `validate`, `plan` and a run under limits
then meet the experiment. What is not allowed: an exception of a library, a crash, more memory than allowed, or a hang
where nothing that takes its time was asked for. Prints what came of them, and every experiment that was not right.
"""

from __future__ import annotations

import json
import pickle
import random
import re
import sys
from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

import yaml

from harness.child_process import Channel, Child
from harness.errors import InputError
from harness.experiment.load import load_text
from harness.process_limits import limit
from harness.runner.point import plan_of
from harness.runner.scene_of_point import SceneSizeError, build_scene
from harness.runner.servers import Servers, files_of, task_of
from harness.scene.launch import PlacementError
from harness.scene.mesh import Mesh
from harness.scene.mesh_child import open_all
from harness.vocabulary import ALGORITHMS

NUMBERS = (0, 1e-30, 1e-20, 1e-9, 1e-3, 0.5, 1, 3, 7, 1e3, 1e6, 1e9, 1e15, 1e20, 1e30)
MODERATE = (0.5, 1, 3, 7)
RUN_SECONDS, PLAN_SECONDS, MEMORY = 3.0, 30.0, "1GiB"
PATIENT_SECONDS = 60.0  # of a run that did not end in the time above
# Sentences of ours, by which a run says that its numbers are beyond it.
OURS = re.compile(r"NotFiniteError: |is not a finite number|^(\w+ is (nan|-?inf)(, )?)+$")


class Extreme:
    """Draws experiments.

    Parameters
    ----------
    chance : where the numbers come from
    """

    def __init__(self, chance: random.Random) -> None:
        self.chance = chance

    def number(self, *, positive: bool = False, signed: bool = False) -> float:
        """Half of them moderate, so that not everything is refused for the first of them."""
        drawn = float(self.chance.choice(MODERATE if self.chance.random() < 0.5 else NUMBERS))
        if positive and drawn == 0:
            drawn = 1e-30
        return -drawn if signed and self.chance.random() < 0.5 else drawn

    def vector(self, **kind: bool) -> list[float]:
        """Three of them."""
        return [self.number(**kind) for _ in range(3)]

    def quantity(self, **kind: bool) -> Any:
        """A number, or a distribution of numbers."""
        form = self.chance.choice(("number", "number", "uniform", "choice"))
        if form == "number":
            return self.number(**kind)
        values = sorted(self.number(**kind) for _ in range(2))
        return {form: values}

    def body(self) -> dict[str, Any]:
        """One body, given in full."""
        body: dict[str, Any] = {"position": self.vector(signed=True)}
        for name in ("velocity", "spin"):
            if self.chance.random() < 0.6:
                body[name] = self.vector(signed=True)
        for name in ("size", "mass"):
            if self.chance.random() < 0.6:
                body[name] = self.number(positive=True)
        if self.chance.random() < 0.2:
            body["orientation"] = [self.number(positive=True), *self.vector(signed=True)]
        return body

    def experiment(self) -> dict[str, Any]:
        """One experiment, legal by every single number."""
        chance = self.chance
        shape = chance.choice(("sphere", "sphere", "hull", "mesh"))
        scene: dict[str, Any] = {"shape": shape} | ({} if shape == "sphere" else {"mesh": "cube.ply"})
        if chance.random() < 0.5:
            scene["bodies"] = [self.body() for _ in range(chance.choice((1, 2, 3)))]
        else:
            scene |= {"count": chance.choice((0, 1, 2, 8, 50)), "overlap": chance.choice(("allow", "reject"))}
            for name, kind in (("size", {"positive": True}), ("speed", {}), ("spin", {})):
                if chance.random() < 0.7:
                    scene[name] = self.quantity(**kind)
            scene["seed"] = chance.choice((0, 259, 2**63 - 1))
        if chance.random() < 0.3:
            scene["box_ratio"] = self.number(positive=True)
        else:
            scene["box"] = self.vector(positive=True)
        motion = {
            "duration": self.number(),
            "dt": self.number(positive=True),
            "response": chance.choice(("reflect", "elastic", "none")),
        }
        if motion["response"] == "elastic":
            motion["restitution"] = chance.choice((0, 1e-30, 1e-9, 0.5, 1))
        algorithm = chance.choice(list(ALGORITHMS))
        engine = {"algorithm": algorithm, "backend": "pybullet" if algorithm == "native" else "fcl"}
        engine["tolerance"] = chance.choice((1e-30, 1e-12, 1e-6, 1, 1e30))
        measure: dict[str, Any] = {"repeats": 1, "timeout": RUN_SECONDS, "memory": MEMORY}
        if chance.random() < 0.3:
            measure["reference"] = {"algorithm": "predictive", "tolerance": chance.choice((1e-12, 1e-10, 1e-3))}
        return {"title": "Extreme", "scene": scene, "motion": motion, "engine": engine, "measure": measure}


def meshes() -> dict[Path, Mesh]:
    """The mesh that all of them may name, opened."""
    path = Path(__file__).parents[2] / "meshes" / "cube.ply"
    return open_all([path])


def outcome(experiment: dict[str, Any], opened: dict[Path, Mesh], servers: Servers) -> tuple[str, str | None]:
    """What comes of an experiment, in a word or two, and what is wrong with that."""
    try:
        loaded = load_text(json.dumps(experiment), Path("extreme.yaml"))
    except InputError as error:
        unplaced = [str(problem) for problem in error.problems if problem.column is None]
        return "refused", f"no place: {unplaced}" if unplaced else None
    point = loaded.points[0]
    cube = next(iter(opened))
    named = dict.fromkeys(loaded.mesh_paths.values(), opened[cube])
    with Child.fork(partial(_plan, loaded, named)) as child:
        planned = child.receive(20 * PLAN_SECONDS)
        told = pickle.loads(planned) if isinstance(planned, bytes) else f"{planned}, {child.end()}"
    if told not in ("planned", "refused"):
        return "plan failed", told
    report = servers.run(*task_of(loaded, point, named))
    if report.status == "ok" or (report.status == "rejected" and told == "refused"):
        return report.status, None
    if report.status == "rejected":
        return "rejected", None if report.reason else "without a reason"
    if report.status == "failed" and OURS.search(report.reason or ""):
        return "not finite", None
    if report.status in ("timeout", "memory") and _is_long(experiment):
        return "long, ended by its limit", None
    if report.status == "timeout" and experiment["measure"]["timeout"] < PATIENT_SECONDS:
        # a busy machine, or kernels that are compiled for the first time
        patient = experiment | {"measure": experiment["measure"] | {"timeout": PATIENT_SECONDS}}
        return outcome(patient, opened, servers)
    return report.status, f"{report.reason}\n{report.stderr}"


def _plan(loaded: Any, named: dict[Path, Mesh], channel: Channel) -> None:
    """In a process of its own: `harness plan`, and how it ends."""
    limit(memory=2**30, cpu=PLAN_SECONDS)
    point = loaded.points[0]
    try:
        plan_of(point, build_scene(point, files_of(loaded, point, named), loaded.measure.memory))
        said = "planned"
    except (InputError, PlacementError, SceneSizeError):
        said = "refused"
    except BaseException as error:
        said = f"{type(error).__name__}: {error}"
    channel.send(pickle.dumps(said))


def _is_long(experiment: dict[str, Any]) -> bool:
    """Whether it asks for more than anybody can do in its time: many frames, or very many hits at the walls."""
    motion, scene = experiment["motion"], experiment["scene"]
    if experiment["engine"]["algorithm"] != "predictive" and motion["duration"] / motion["dt"] > 1e4:
        return True
    speeds = [1.5 if "speed" not in scene else max(_values(scene["speed"]))]
    for body in scene.get("bodies", ()):
        speeds.append(max(map(abs, body.get("velocity", [0]))))
        if scene["shape"] != "sphere":  # a surface that spins meets the walls as one that flies
            speeds.append(max(map(abs, body.get("spin", [0]))) * body.get("size", 1))
    room = min(scene["box"]) if "box" in scene else 0.0
    return room == 0.0 or max(speeds) * motion["duration"] / room > 1e4


def _values(quantity: Any) -> list[float]:
    if isinstance(quantity, dict):
        (values,) = quantity.values()
        return list(values)
    return [quantity]


def main(count: int, seed: int) -> None:
    """So many experiments, and what came of them."""
    chance, opened, found, wrong = random.Random(seed), meshes(), Counter[str](), 0
    with Servers() as servers:
        for number in range(count):
            experiment = Extreme(chance).experiment()
            word, complaint = outcome(experiment, opened, servers)
            found[word] += 1
            if complaint is not None:
                wrong += 1
                print(
                    f"--- {number}: {word}: {complaint}\n{yaml.safe_dump(experiment, default_flow_style=None)}",
                    flush=True,
                )
    print(f"{count} experiments (seed {seed}): {dict(found.most_common())}; {wrong} not right")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000, int(sys.argv[2]) if len(sys.argv) > 2 else 259)
