"""Packages whose files are found by looking: what a new file adds is there, and no list names it."""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType


def modules_in(package: str) -> list[ModuleType]:
    """Every module of a package, imported, in the order of their names."""
    names = sorted(found.name for found in iter_modules(import_module(package).__path__) if not found.ispkg)
    return [import_module(f"{package}.{name}") for name in names]
