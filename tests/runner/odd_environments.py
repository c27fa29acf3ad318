"""The real commands in environments of all kinds: each does its work, or says in a sentence why it cannot.

    python tests/runner/odd_environments.py [ENVIRONMENT ...]

Each command takes a second or a few of CPU time where the kernels of the sources are kept, so that the plain
environment always comes first; where they are not, and may not be written, each would compile them for itself.

Without a home, with folders that may not be written to, with little of everything, closed streams, other languages,
warnings as errors. Prints what came of each, and how many tries went wrong: a trace of the program's own code, an exit
code that is none of ours, silence, or work that was not done where nothing kept it from being done.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

EXPERIMENT = """
title: Odd
scene: {mesh: cube.ply, shape: hull, count: 4, box: [5, 5, 5]}
motion: {duration: 0.05, response: none}
engine: {algorithm: grid}
measure: {repeats: 1, reference: {tolerance: 1.0e-8}}
"""
COMMANDS = {
    "sweep": ["sweep", "odd.yaml", "--db", "odd.db"],
    "export": ["export", "--db", "odd.db", "--format", "json"],
    "report": ["report", "--db", "odd.db", "--out", "pages"],
    "inspect": ["mesh", "inspect", "cube.ply", "--json"],
    "view": ["view", "odd.yaml", "--out", "replay.html"],
    "compare": ["compare", "odd.yaml", "--backends", "fcl,pybullet", "--budget", "2", "--json"],
    "list": ["list", "--json"],
    "plan": ["plan", "odd.yaml"],
    "trace": ["trace", "odd.yaml", "--json"],
    "jobs": ["sweep", "odd.yaml", "--db", "jobs.db", "--jobs", "2"],
    "new": ["new", "another.yaml"],
}
JSON = ("export", "inspect", "compare", "list", "trace")
LONGEST = 300.0  # s for a command, on a machine with other things to do
NOWHERE = "/there/is/no/such/folder"


@dataclass
class Environment:
    """What is odd: variables (None: without it), limits of the system, streams that are closed.

    Parameters
    ----------
    may_fail : whether it may keep commands from their work, so that a sentence and exit code 1 or 2 will do
    longest : s for a command
    prepare : what is done to the folder of the work and the one above it, before
    """

    variables: dict[str, str | None] = field(default_factory=dict)
    limits: dict[int, int] = field(default_factory=dict)
    closed: tuple[int, ...] = ()
    may_fail: bool = False
    prepare: Callable[[Path], None] = lambda _: None
    output: str | None = None
    longest: float = LONGEST

    def begin(self) -> None:
        """In the process that becomes the command."""
        for what, most in self.limits.items():
            resource.setrlimit(what, (most, most))
        for descriptor in self.closed:
            os.close(descriptor)


def _locked(folder: Path) -> None:
    """A folder for TMPDIR and HOME that nobody may write to; root may, unless it is no folder."""
    (folder / "locked").mkdir(mode=0o555)
    (folder / "file").write_text("")


ALL = ("HOME", "TMPDIR", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "MPLCONFIGDIR")
ENVIRONMENTS = {
    "plain": Environment(longest=4 * LONGEST),  # it compiles what the others find
    "no HOME": Environment({"HOME": None}),
    "HOME that is not there": Environment({"HOME": NOWHERE}),
    "HOME that may not be written to": Environment({"HOME": "{folder}/locked"}, prepare=_locked),
    "HOME that is a file": Environment({"HOME": "{folder}/file"}, prepare=_locked),
    "TMPDIR that is not there": Environment({"TMPDIR": NOWHERE}),
    "TMPDIR that may not be written to": Environment({"TMPDIR": "{folder}/locked"}, prepare=_locked),
    "TMPDIR that is a file": Environment({"TMPDIR": "{folder}/file"}, prepare=_locked),
    "none of them": Environment(dict.fromkeys(ALL, NOWHERE)),
    "no variables": Environment(dict.fromkeys((*ALL, *os.environ), None)),
    "LANG=C": Environment({"LANG": "C", "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}),
    "PYTHONOPTIMIZE=1": Environment({"PYTHONOPTIMIZE": "1"}),
    "PYTHONOPTIMIZE=2": Environment({"PYTHONOPTIMIZE": "2"}),
    "PYTHONWARNINGS=error": Environment({"PYTHONWARNINGS": "error"}),
    "40 columns": Environment({"COLUMNS": "40"}),
    "1 column": Environment({"COLUMNS": "1"}),
    "LANG=C, PYTHONOPTIMIZE=1, PYTHONWARNINGS=error and 40 columns": Environment(
        {
            "LANG": "C",
            "LC_ALL": "C",
            "PYTHONUTF8": "0",
            "PYTHONCOERCECLOCALE": "0",
            "PYTHONOPTIMIZE": "1",
            "PYTHONWARNINGS": "error",
            "COLUMNS": "40",
        }
    ),
    "files of 0 bytes": Environment(limits={resource.RLIMIT_FSIZE: 0}, may_fail=True),
    "files of 8 KiB": Environment(limits={resource.RLIMIT_FSIZE: 8 << 10}, may_fail=True),
    "files of 60 KiB": Environment(limits={resource.RLIMIT_FSIZE: 60 << 10}, may_fail=True),
    "memory of 400 MB": Environment(limits={resource.RLIMIT_AS: 400_000_000}, may_fail=True),
    "memory of 2 GB": Environment(limits={resource.RLIMIT_AS: 2_000_000_000}, may_fail=True),
    "CPU time of 1 s": Environment(limits={resource.RLIMIT_CPU: 1}, may_fail=True),
    "20 open files": Environment(limits={resource.RLIMIT_NOFILE: 20}, may_fail=True),
    "standard output closed": Environment(closed=(1,)),
    "all streams closed": Environment(closed=(0, 1, 2)),
    "a full disk behind standard output": Environment(may_fail=True, output="/dev/full"),
}


def attempt(name: str, folder: Path, words: list[str]) -> tuple[int, str, str]:
    """A command in an environment."""
    odd = ENVIRONMENTS[name]
    variables = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, [str(Path(__file__).parents[2]),
                                                                         os.environ.get("PYTHONPATH")]))}  # fmt: skip
    for variable, value in odd.variables.items():
        variables.pop(variable, None)
        if value is not None:
            variables[variable] = value.replace("{folder}", str(folder))
    with open(odd.output or os.devnull, "w") as lost:
        try:
            done = subprocess.run(
                [sys.executable, "-m", "harness", *words],
                cwd=folder, env=variables, stdin=subprocess.DEVNULL, stdout=lost if odd.output else subprocess.PIPE,
                stderr=subprocess.PIPE, preexec_fn=odd.begin, timeout=odd.longest, text=True, errors="replace",
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return -1, "", f"Traceback: it did not end within {odd.longest:g} s"
    return done.returncode, done.stdout or "", done.stderr


def wrong(name: str, command: str, code: int, output: str, errors: str) -> str | None:
    """What is not right about the end of a command."""
    odd = ENVIRONMENTS[name]
    ended_by_limit = resource.RLIMIT_CPU in odd.limits and code in (-24, -9)
    if "Traceback" in errors or "[Errno" in errors:
        return errors[-600:]
    if code not in ((0, 1, 2) if odd.may_fail else (0,)) and not ended_by_limit:
        return f"exit code {code}: {errors[-400:]}"
    if code and not errors and not odd.closed and not ended_by_limit:
        return "failed without a word"
    if command in JSON and output:
        try:
            json.loads(output)
        except ValueError:
            return f"no JSON: {output[:200]!r}"
    if not odd.may_fail and not odd.closed and not output:
        return "nothing was said"
    return None


def folder_for(name: str, above: Path) -> Path:
    """A folder to work in, with an experiment and a mesh."""
    folder = above / "work"
    folder.mkdir()
    (folder / "odd.yaml").write_text(EXPERIMENT)
    (folder / "cube.ply").write_bytes((Path(__file__).parents[2] / "meshes/cube.ply").read_bytes())
    ENVIRONMENTS[name].prepare(folder)
    return folder


def main(names: list[str]) -> None:
    """Every environment, every command."""
    tries, failures = 0, 0
    for name in dict.fromkeys(["plain", *(names or ENVIRONMENTS)]):
        with tempfile.TemporaryDirectory() as above:
            folder, said = folder_for(name, Path(above)), []
            for command, words in COMMANDS.items():
                code, output, errors = attempt(name, folder, words)
                tries += 1
                complaint = wrong(name, command, code, output, errors)
                failures += complaint is not None
                said.append(f"{command} {code}" if complaint is None else f"{command} {code} WRONG: {complaint}")
            print(f"{name}: {', '.join(said)}", flush=True)
    print(f"{tries} tries, {failures} failures")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
