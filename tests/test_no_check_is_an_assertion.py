"""With PYTHONOPTIMIZE=1 assertions are not run: none of the program may check anything that could be false."""

import ast
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "harness"


def tells_a_type(test: ast.expr) -> bool:
    """Whether it only tells a type checker what is so by construction: `x is not None`, `isinstance(x, A)`."""
    if isinstance(test, ast.Compare):
        (operator,), (right,) = test.ops, test.comparators
        return isinstance(operator, ast.IsNot) and isinstance(right, ast.Constant) and right.value is None
    return isinstance(test, ast.Call) and isinstance(test.func, ast.Name) and test.func.id == "isinstance"


def test_assertions_only_tell_types():
    checks = [
        f"{file.relative_to(PACKAGE)}:{node.lineno}"
        for file in sorted(PACKAGE.rglob("*.py"))
        if "assert" in (text := file.read_text(encoding="utf-8"))  # else there is nothing to look for in its tree
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Assert) and not tells_a_type(node.test)
    ]
    assert checks == []
