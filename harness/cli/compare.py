"""Hold backends against each other, and against exact arithmetic, on the same poses.

The bodies of each scene fly through each other, whatever its response, and every backend is asked about every frame;
scenes of random bodies are followed by pairs at first contact, where verdicts are hardest. Exits 1 if a backend is
wrong beyond what its tolerance or its approximation explains, or fails at a pose.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from harness.cli.overrides import add_override_argument, overrides_of

if TYPE_CHECKING:
    from pathlib import Path

    from harness.compare.comparison import Case, Comparison, Failure
    from harness.compare.poses import PoseSet
    from harness.experiment.experiment import Experiment
    from harness.scene.mesh import Mesh

DEFAULT = ("fcl", "pybullet")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command takes."""
    parser.add_argument("paths", metavar="PATH", nargs="+", help="experiment files, or folders of them")
    parser.add_argument(
        "--backends",
        metavar="A,B",
        help=f"two or more; those that the experiment names where it names several, else {','.join(DEFAULT)}",
    )
    add_override_argument(parser)
    parser.add_argument(
        "--save", metavar="DIR", help="write real disagreements as the smallest experiments that show them"
    )
    parser.add_argument("--json", action="store_true", help="one JSON document on standard output")


def run(arguments: argparse.Namespace) -> int:
    """Compare, print, and say by the exit code whether anyone was wrong."""
    import json
    import sys

    from harness.compare.comparison import Comparison, compare
    from harness.runner.preparation import prepare

    def progress(line: str) -> None:
        print(line, file=sys.stderr)

    chosen = _chosen(arguments.backends)
    experiments, meshes = prepare(arguments.paths, overrides_of(arguments))
    whole = Comparison()
    for experiment in experiments:
        names = chosen or _named(experiment)
        print(f"{experiment.name}: {', '.join(names)}", file=sys.stderr)
        whole.add(compare(_settings(experiment, meshes), names, progress))
    files = _saved(whole, meshes, arguments.save) if arguments.save else {}
    if arguments.json:
        json.dump(_document(whole, files), sys.stdout, allow_nan=False)
        print()
        for line in whole.unsupported:
            print(line, file=sys.stderr)
    else:
        _print(whole)
    return 0 if whole.passed else 1


def _chosen(text: str | None) -> tuple[str, ...]:
    """The backends that `--backends` names."""
    from harness.backends.registry import names
    from harness.errors import InputError
    from harness.experiment.messages import listed, near, shown

    if text is None:
        return ()
    chosen = tuple(dict.fromkeys(name.strip() for name in text.split(",") if name.strip()))
    for name in chosen:
        if name not in names():
            raise InputError(
                f"--backends: unknown backend {shown(name)}{near(name, names()) or f'; there are {listed(names())}'}"
            )
    if len(chosen) < 2:
        raise InputError("--backends: two backends at least, such as fcl,pybullet")
    return chosen


def _named(experiment: Experiment) -> tuple[str, ...]:
    named = tuple(dict.fromkeys(point.engine.backend for point in experiment.points))
    return named if len(named) > 1 else DEFAULT


def _settings(experiment: Experiment, meshes: dict[Path, Mesh]) -> Iterator[PoseSet]:
    """What the experiment's points fly through, each scene once; then the hard poses of every shape of a mesh."""
    from harness.compare.hard import hard_poses
    from harness.compare.poses import flown
    from harness.errors import InputError
    from harness.runner.servers import mesh_of
    from harness.runner.setting import SceneSizeError, build_scene
    from harness.scene.launch import PlacementError

    seen = set()
    for point in experiment.points:
        moved = (point.scene, point.motion.duration, point.motion.dt)
        if repr(moved) in seen:
            continue
        seen.add(repr(moved))
        try:
            scene = build_scene(point, mesh_of(experiment, point, meshes), experiment.measure.memory)
        except (PlacementError, SceneSizeError) as error:
            raise InputError(f"{experiment.path}: {error}") from error
        if len(scene.bodies) > 1:
            yield flown(scene, point.motion.frames, point.motion.dt)
    random = {(point.scene.shape, point.scene.mesh): point for point in experiment.points if point.scene.bodies is None}
    for (shape, _), point in random.items():
        yield from hard_poses(shape, mesh_of(experiment, point, meshes))


# Minimising a case asks the backends some ten times; more cases of one backend show the same defect again.
MOST_SAVED = 5


def _saved(found: Comparison, meshes: dict[Path, Mesh], folder: str) -> dict[int, str]:
    """The files of the first cases that every backend has lost, by the place of the case."""
    import sys
    from pathlib import Path

    from harness.compare.minimise import minimise
    from harness.compare.reproduction import save

    files: dict[int, str] = {}
    tried: dict[str, int] = {}
    for place, case in enumerate(found.cases):
        tried[case.wrong] = tried.get(case.wrong, 0) + 1
        if tried[case.wrong] > MOST_SAVED:
            continue
        small = minimise(case)
        if small is None:
            print(
                f"{case.wrong}, {case.pose.name}, call {case.call}: it depends on what was asked before",
                file=sys.stderr,
            )
            continue
        mesh = next((path for path, opened in meshes.items() if opened is case.scene.mesh), None)
        files[place] = str(save(small, Path(folder), place, mesh))
    return files


def _document(found: Comparison, files: dict[int, str]) -> dict[str, Any]:
    from dataclasses import asdict

    pairs = [{**asdict(tally), "backends": list(tally.backends)} for tally in found.tallies]
    cases = [_case(case, files.get(place)) for place, case in enumerate(found.cases)] + [
        _failure(failure) for failure in found.failures
    ]
    return {"pairs": pairs, "cases": cases}


def _case(case: Case, file: str | None) -> dict[str, Any]:
    where = {"pose": case.pose.name, "call": case.call, "touching": case.judgement.touching}
    return {
        "backends": list(case.backends),
        "wrong": case.wrong,
        "bodies": list(case.bodies),
        "gap": case.judgement.gap,
        "certificate": case.judgement.certificate | where,
        "file": file,
    }


def _failure(failure: Failure) -> dict[str, Any]:
    """A crash has no bodies, no gap and no proof but its reason."""
    return {
        "backends": list(failure.backends),
        "wrong": failure.backend,
        "bodies": [],
        "gap": None,
        "certificate": {"kind": "crashed", "pose": failure.pose, "call": failure.call, "reason": failure.reason},
        "file": None,
    }


def _print(found: Comparison) -> None:
    kinds = ("agree", "undecided", "containment", "approximation", "real")
    for tally in found.tallies:
        counts = ", ".join(f"{kind} {getattr(tally, kind)}" for kind in kinds)
        print(
            f"{' and '.join(tally.backends)}, {tally.shape}: {tally.verdicts} verdicts at {tally.poses} poses: {counts}"
        )
    for line in found.unsupported:
        print(line)
    for case in found.cases:
        truth = case.judgement
        state = f"overlap by {-truth.gap:.3g} m" if truth.touching else f"are {truth.gap:.3g} m apart"
        i, j = case.bodies
        print(
            f"{case.wrong} is wrong: at {case.pose.name} (call {case.call}) bodies {i} and {j} {state}, "
            f"proven by a {truth.certificate['kind']}"
        )
    for failure in found.failures:
        print(f"{failure.backend} failed at {failure.pose} (call {failure.call}): {failure.reason}")
