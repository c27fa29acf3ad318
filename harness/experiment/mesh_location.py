"""Where a mesh that an experiment names is found, and where it may not be.

An experiment may come from anywhere and is not trusted: what it names must lie in its own folder, in a folder of
meshes, or among the data of an installed package, symbolic links followed.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

from harness.errors import InputError, NotInstalledError
from harness.experiment.messages import near, shown
from harness.vocabulary import MESH_FORMATS

PACKAGE = "package:"
_MOST_LISTED = 1000
# what brings a package whose own name does not say so
_BROUGHT_BY = {"pybullet_data": "pip install 'harness[pybullet]'"}


def locate_mesh(reference: str, beside: Path) -> Path:
    """The file that a reference means: in the folder `beside`, in ./meshes, or in meshes/ beside the harness package.

    Parameters
    ----------
    reference : a path, or `package:NAME/PATH` for a file of an installed package, which is not imported
    beside : the folder of the experiment

    Returns
    -------
    Path
        Absolute, symbolic links followed.

    Raises
    ------
    NotInstalledError
        If it lies in a package that is not installed.
    InputError
        If there is no such file, or it is not where meshes may be.
    """
    package, relative = None, reference
    if reference.startswith(PACKAGE):
        package, _, relative = reference.removeprefix(PACKAGE).partition("/")
        roots = [_package_folder(package, reference)]
    else:
        roots = [beside, Path("meshes"), Path(__file__).resolve().parents[2] / "meshes"]
    allowed = [root.resolve() for root in roots]
    outside = False
    for root in roots:
        found = _file(root, relative)
        if found is not None and any(found.is_relative_to(folder) for folder in allowed):
            return found
        outside |= found is not None
    if outside:
        where = f"the package {package}" if package else "the experiment's folder and the folders of meshes"
        raise InputError(f"the mesh {shown(reference)} lies outside of {where}")
    prefix = f"{PACKAGE}{package}/" if package else ""
    there = next(filter(None, (_no_file(root, relative) for root in roots)), None)
    hint = f": it is {there}" if there else near(reference, (prefix + n for root in roots for n in _meshes_in(root)))
    where = f"in the package {package}" if package else "beside the experiment or in meshes/"
    raise InputError(f"there is no mesh {shown(reference)} {where}{hint}")


def _package_folder(name: str, reference: str) -> Path:
    if not name.isidentifier():
        raise InputError(f"{shown(reference)} must be {PACKAGE}NAME/PATH, with the name of a package to import")
    try:
        # Of a name without dots this looks for the package and runs nothing of it.
        found = importlib.util.find_spec(name)
    except (ImportError, ValueError):
        found = None
    if found is None:
        how = f"; {_BROUGHT_BY[name]} brings it" if name in _BROUGHT_BY else ""
        raise NotInstalledError(f"the package {shown(name)} is not installed{how}")
    # A folder without code is a package to Python too, any folder where the program was started among them.
    if found.origin is None or not found.submodule_search_locations:
        raise InputError(f"{shown(name)} is not a package that could hold data")
    return Path(found.origin).parent


def _file(root: Path, relative: str) -> Path | None:
    try:
        path = root / relative
        return path.resolve() if path.is_file() else None
    except (OSError, ValueError, RuntimeError):  # a name too long, with a zero in it, or links that go round in circles
        return None


def _no_file(root: Path, relative: str) -> str | None:
    """What stands there that is no file, if anything does; nothing is said of what lies outside."""
    try:
        path = root / relative
        if not path.parent.resolve().is_relative_to(root.resolve()):
            return None
        if path.is_dir():
            return "a folder"
        if path.exists():
            return "a pipe or a device"
        return "a link that leads to no file" if path.is_symlink() else None
    except (OSError, ValueError, RuntimeError):  # as in `_file`
        return None


def _meshes_in(root: Path) -> Iterator[str]:
    try:
        for path in islice(root.iterdir(), _MOST_LISTED):
            if path.suffix.lower().removeprefix(".") in MESH_FORMATS:  # what is read, which alone is suggested
                yield path.name
    except OSError:
        return
