"""Methods by name: a file of this folder where there is one, else the broad phase that the algorithm is named after."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from importlib.util import find_spec

from harness.methods.method import Method
from harness.vocabulary import MethodName


def method_of(
    name: MethodName,
    *,
    tolerance: float = 1e-6,
    within: float | None = None,
    forced: Mapping[str, bool] | None = None,
    threads: int = 1,
) -> Method:
    """The method of a name, set as a run has it.

    Parameters
    ----------
    name : MethodName
        Of an algorithm in `harness.vocabulary.ALGORITHMS`.
    tolerance, within, forced, threads : see `Method`
    """
    module = f"harness.methods.{name.algorithm.replace('-', '_')}"
    if find_spec(module) is None:
        module = "harness.methods.culled"
    made: type[Method] = import_module(module).METHOD
    return made(name, tolerance=tolerance, within=within, forced=forced, threads=threads)
