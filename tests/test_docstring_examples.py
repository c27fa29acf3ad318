"""The examples in docstrings come out as they are written."""

import doctest
from importlib import import_module
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "harness"
MODULES = [
    ".".join(file.relative_to(PACKAGE.parent).with_suffix("").parts)
    for file in sorted(PACKAGE.rglob("*.py"))
    if ">>> " in file.read_text(encoding="utf-8")
]


# its examples sweep, run and trace
SLOW = ("harness.__init__",)


@pytest.mark.parametrize(
    "module", [pytest.param(module, marks=pytest.mark.slow if module in SLOW else ()) for module in MODULES]
)
def test_an_example_gives_what_it_says(module):
    found = import_module(module)
    # a compiled function has the docstring of its source, but is none that doctest looks for
    named = {name: getattr(value, "py_func", value) for name, value in vars(found).items()}
    finder, runner = doctest.DocTestFinder(), doctest.DocTestRunner()
    own = [value for value in named.values() if getattr(value, "__module__", None) == module and callable(value)]
    examples = [example for value in own for example in finder.find(value, globs=dict(vars(found)))]
    for example in examples:
        runner.run(example)
    assert runner.summarize(verbose=False).failed == 0
    assert any(example.examples for example in examples)
