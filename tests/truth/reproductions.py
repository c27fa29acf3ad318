"""Writes files that show, without this program, wrong answers of libraries to cases of the published set.

    python -m tests.truth.reproductions

Of each library, family and shape the farthest wrong answer that a file can show, of the cases with the fewest faces.
Every library that is asked has to be installed.
"""

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from harness.compare.judge import judge
from harness.compare.outcome import Case
from harness.compare.poses import Frame
from harness.compare.question import Question
from harness.compare.script import script_of
from harness.errors import InputError
from harness.truth.answerers import answerer, asked_engines
from harness.truth.case_scene import CaseScenes
from harness.truth.folder import read_set

PUBLISHED = Path(__file__).parents[2] / "results/published/truth"
LIBRARIES = ["fcl", "rapier3d"]
_MOST = 20  # cases of a library, family and shape
_HALVINGS = 24


def wrong_answer(scenes, row, bracket, asked, name) -> Case | None:
    """What it says of a case, where that is wrong by more than its tolerance."""
    motion, scene, (lower, upper) = scenes.motion(row), scenes.scene(row), bracket
    told = asked.answer(row)
    parts = motion.positions, motion.quaternions, motion.velocities, motion.spins
    frame = Frame(f"case {row + 1} of the set", *parts, motion.duration, 1)

    def truth(moment):
        there = frame.at(scene, moment)
        return judge(scene, 0, 1, there.positions, there.quaternions)

    def case(moment) -> Case:
        return Case((name, "x"), name, (0, 1), truth(moment), scene, frame, 1, Question("impact"), told.time, moment)

    if told.time < lower:
        return case(told.time) if truth(told.time).gap > told.tolerance else None
    last = min(told.time, motion.duration)
    for power in range(_HALVINGS if last > upper else 0):
        moment = upper + (last - upper) * 0.5**power
        if truth(moment).gap < -told.tolerance:
            return case(moment)
    return None


def groups(given, scenes) -> Iterator[tuple[str, str, list[int]]]:
    """Families and shapes, with the cases of each that are apart at the start, the simplest first."""
    cases, solids = given.cases, given.solids.all
    found = {}
    for row in range(len(cases.windows)):
        shape = scenes.shape(row)
        if shape != "sphere" and cases.lower[row] > 0.0:
            found.setdefault((str(cases.families[row]), shape), []).append(row)

    def faces(row):
        return sum(len(solids[int(side.meshes[row])].surface.faces) for side in (cases.first, cases.second))

    for (family, shape), rows in sorted(found.items()):
        yield family, shape, sorted(rows, key=faces)[:_MOST]


def farthest_first(case):
    return -abs(case.judgement.gap) / case.scene.bodies.sizes.min()


def written(folder: Path) -> list[str]:
    """Write the files; the names of those that were."""
    given = read_set(PUBLISHED)
    scenes, names = CaseScenes(given), []
    for name in LIBRARIES:
        (question,) = asked_engines([name], [])
        asked = answerer(question, scenes)
        for family, shape, rows in groups(given, scenes):
            found = []
            for row in rows:
                bracket = float(given.cases.lower[row]), float(given.cases.upper[row])
                with suppress(InputError, TimeoutError):
                    found.append(wrong_answer(scenes, row, bracket, asked, name))
            for case in sorted(filter(None, found), key=farthest_first):
                text = script_of(case)
                if text is not None:
                    names.append(f"{name}-{family}-{shape}.py")
                    (folder / names[-1]).write_text(text)
                    break
    return names


if __name__ == "__main__":
    home = PUBLISHED / "reproductions"
    home.mkdir(exist_ok=True)
    for old in home.glob("*.py"):
        old.unlink()
    print(len(written(home)), "files")
