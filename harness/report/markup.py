"""HTML of the pages: from templates, and of a table or a figure by itself."""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from harness.report.drawing import palette
from harness.report.figure import Figure
from harness.report.table import Table

_SCRIPTS = ("sort.js", "finder.js", "parquet.js", "explore.js")


def render(template: str, **values: Any) -> Markup:
    """A template of `harness/report/templates/`, filled in. What does not come as Markup is escaped."""
    return Markup(_environment().get_template(template).render(**values))


def report_command(commands: Iterable[str]) -> str:
    """The command that makes the pages of what these have kept: of the same results file, if they name one.

    >>> report_command(["harness sweep x.yaml --db 'my results.db'"]), report_command(["harness sweep"])
    ("harness report --db 'my results.db'", 'harness report')
    """
    for command in commands:
        try:
            words = shlex.split(command)
        except ValueError:  # a quote that is not closed: no command of this program has one
            continue
        for word, following in zip(words, [*words[1:], ""], strict=True):
            if word == "--db" or word.startswith("--db="):
                return shlex.join(["harness", "report", "--db", word.partition("=")[2] or following])
    return "harness report"


def script() -> str:
    """The one script of a report: conveniences, without which every page reads in full."""
    templates = files("harness.report") / "templates"
    return "\n".join((templates / name).read_text(encoding="utf-8") for name in _SCRIPTS)


def section_html(identity: str, heading: str, *parts: Table | Figure | Markup | str) -> Markup:
    """A section of a page: a heading, and below it tables, figures and paragraphs."""
    show: Any = _environment().get_template("macros.html.j2").module
    body = Markup("\n").join(_part(show, part) for part in parts)
    return Markup('<section id="{}"><h2>{}</h2>\n{}\n</section>').format(identity, heading, body)


def _part(show: Any, part: Table | Figure | Markup | str) -> Markup:
    if isinstance(part, Table):
        return Markup(show.table(part))
    if isinstance(part, Figure):
        return Markup(show.plot(part, f"figure-{part.name}"))
    return part if isinstance(part, Markup) else Markup("<p>{}</p>").format(part)


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("harness.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=False
    )
    templates = files("harness.report") / "templates"
    environment.globals |= {
        "style": Markup((templates / "style.css").read_text(encoding="utf-8")),
        "light": Markup(palette.variables(dark=False)),
        "dark": Markup(palette.variables(dark=True)),
        "report_command": report_command,
        "colours": len(palette.LIGHT),
        "outlines": [palette.OUTLINES[marker] for marker in palette.MARKERS],
    }
    return environment
