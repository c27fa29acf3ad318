"""The page that plays a recording: one file that asks for nothing else, the same bytes for the same recording."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from typing import NamedTuple

from jinja2 import Environment, PackageLoader, StrictUndefined, Template
from markupsafe import Markup

from harness.replay.document import Fact, document, view_box
from harness.replay.kept_still import still_of
from harness.store.recording import Recording

# Each imports only from those before it; `main` starts the page.
MODULES = (
    "matrix", "recording", "surface", "shaders", "camera", "stage", "clock", "timeline", "hitlist", "replay", "live",
    "main",
)  # fmt: skip
_IMPORT = re.compile(r"^import [^;]*;\n", re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function|class|const)\b)", re.MULTILINE)


class Input(NamedTuple):
    """An input of the form on a live page: a list to choose from where it has options, else a text."""

    name: str
    label: str
    value: str
    options: tuple[str, ...] = ()
    inputmode: str = "decimal"


def replay_page(
    recording: Recording, title: str, facts: Sequence[Fact] = (), *, back: str = "", picture: str = ""
) -> str:
    """The replay as one HTML file.

    Parameters
    ----------
    recording : what to play
    title : its heading
    facts : names and values to stand beside it
    back : a link to the page that it belongs to, if there is one
    picture : the still of it as `still_text` gives it, where that is at hand
    """
    text = json.dumps(document(recording, title, facts), ensure_ascii=False, separators=(",", ":"))
    text = text.replace("<", "\\u003c")  # so that nothing in it ends the script element
    picture = picture or still_text(recording)
    return _page(
        title,
        f"{summary(recording)}.",
        facts,
        back=back,
        still=picture,
        alt=described(recording),
        recording=Markup(text),
    )


def still_text(recording: Recording) -> str:
    """The still picture, a PNG, in base64."""
    return base64.b64encode(still_of(recording)).decode("ascii")


def live_page(title: str, inputs: Sequence[Input], columns: Sequence[str]) -> str:
    """The page on which a person changes the scene and sees what it costs.

    Parameters
    ----------
    title : its heading
    inputs : of its form, with the values to begin with
    columns : of the table of costs
    """
    sentence = (
        "Change a value: the scene is run again at once, shown, and its hits and costs are put on top of the table."
    )
    return _page(title, sentence, (), inputs=tuple(inputs), columns=tuple(columns), alt="The scene that was run last.")


def summary(recording: Recording) -> str:
    """What a recording shows, in a phrase."""
    look = ", ".join(surface.name for surface in recording.surfaces) or "sphere"
    bodies = f"{len(recording)} {'body' if len(recording) == 1 else 'bodies'} ({look})"
    pairs = int((recording.hit_walls < 0).sum())
    how = "from hit to hit" if recording.dt is None else f"in frames of {recording.dt * 1000:.4g} ms"
    walls = len(recording.hit_walls) - pairs
    hits = f"{pairs} hits between bodies and {walls} at walls"
    if recording.near is not None:
        hits = f"two bodies come near each other {pairs} {'time' if pairs == 1 else 'times'}, and {walls} hits at walls"
    return f"{bodies} for {recording.duration:g} s, computed {how}: {hits}"


def described(recording: Recording) -> str:
    """The picture in words, for screen readers."""
    _, halves = view_box(recording)
    sides = " × ".join(f"{2 * half:.4g}" for half in halves)
    space = "A box of" if recording.half_box is not None else "A space without walls of"
    return f"{space} {sides} m with {summary(recording)}."


def _page(
    title: str,
    subtitle: str,
    facts: Sequence[Fact],
    *,
    back: str = "",
    still: str = "",
    alt: str = "",
    recording: Markup | None = None,
    inputs: tuple[Input, ...] = (),
    columns: tuple[str, ...] = (),
) -> str:
    return _template().render(
        title=title,
        subtitle=subtitle,
        facts=facts,
        back=back,
        still=still,
        alt=alt,
        recording=recording,
        inputs=inputs,
        columns=columns,
        style=Markup(_style()),
        script=Markup(_script()),
    )


@cache
def _template() -> Template:
    environment = Environment(
        loader=PackageLoader("harness.replay", "viewer"), autoescape=True, undefined=StrictUndefined
    )
    return environment.get_template("page.html.j2")


@cache
def _style() -> str:
    return _source("style.css")


@cache
def _script() -> str:
    """All modules as one: in this order none needs to import another."""
    return "\n".join(_EXPORT.sub("", _IMPORT.sub("", _source(f"{name}.js"))) for name in MODULES)


def _source(name: str) -> str:
    return (files("harness.replay") / "viewer" / name).read_text(encoding="utf-8")
