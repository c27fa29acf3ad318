"""A copy of the program, into which a newcomer's files are written, and whose commands are run."""

import json
import os
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

from numba.core.caching import _CacheLocator

PACKAGE = Path(__file__).parents[1] / "harness"


class ProgramCopy:
    """The package in a folder of its own.

    `touched` are the files that were added or changed since. Kernels of records cannot do without the compiler, so that
    what is compiled is copied as well; where little is computed, `compiled=False` waits for no compiler.
    """

    def __init__(self, folder, compiled=True):
        self.folder, self.touched = folder, []
        self.environment = os.environ | {"PYTHONPATH": str(folder)} | ({} if compiled else {"NUMBA_DISABLE_JIT": "1"})
        # with what Python has compiled of its sources, which would take each command a second and a half
        shutil.copytree(PACKAGE, folder / "harness", ignore=shutil.ignore_patterns("kernels-*"))
        if compiled:
            self._copy_kernels()

    def _copy_kernels(self):
        """numba keeps the kernels of a folder under a name that is made of the folder's path."""
        folders = [PACKAGE, *(path for path in PACKAGE.rglob("*") if path.is_dir())]
        kept = {_name_in_cache(path): path.relative_to(PACKAGE) for path in folders}
        for kernels in (PACKAGE / "__pycache__").glob("kernels-*/*"):
            if kernels.name in kept:
                name = _name_in_cache(self.folder / "harness" / kept[kernels.name])
                shutil.copytree(kernels, self.folder / "harness/__pycache__" / kernels.parent.name / name)

    def add(self, path, text):
        """A file that there was not."""
        assert not (self.folder / path).exists()
        (self.folder / path).write_text(textwrap.dedent(text))
        self.touched.append(path)

    def add_algorithm(self, name, meaning):
        """A line of `ALGORITHMS` in the vocabulary."""
        self._add_word("ALGORITHMS: dict[str, AlgorithmWord] = {\n", f'"{name}": AlgorithmWord("{meaning}")')

    def add_mesh_format(self, name, meaning):
        """A line of `MESH_FORMATS` in the vocabulary."""
        self._add_word("MESH_FORMATS = {\n", f'"{name}": "{meaning}"')

    def _add_word(self, start, entry):
        file = self.folder / "harness/vocabulary.py"
        head, start, rest = file.read_text().partition(start)
        file.write_text(f"{head}{start}    {entry},\n{rest}")
        self.touched.append("harness/vocabulary.py")

    def run(self, *words):
        """What a command prints."""
        ran = self._ran(*words)
        assert ran.returncode == 0, ran.stderr
        return ran.stdout

    def refused(self, *words):
        """What a command says that finds its input wrong."""
        ran = self._ran(*words)
        assert ran.returncode == 2, ran.stderr
        return ran.stderr

    def _ran(self, *words):
        return subprocess.run(
            [sys.executable, "-m", "harness", *map(str, words)],
            cwd=self.folder, env=self.environment, capture_output=True, text=True,
        )  # fmt: skip

    def sweep(self, *experiments):
        """The runs of experiment files, by the name of the experiment, in a fresh database."""
        (self.folder / "results.db").unlink(missing_ok=True)
        self.run("sweep", *experiments, "--db", "results.db", "--quiet")
        runs = json.loads(self.run("export", "--db", "results.db", "--format", "json"))["runs"]
        assert {run["status"] for run in runs} == {"ok"}
        return {run["experiment"]: run for run in runs}


def _name_in_cache(folder):
    return _CacheLocator.get_suitable_cache_subpath(str(folder / "any.py"))
