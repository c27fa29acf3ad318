"""A YAML document as plain values, each with its line and column.

Composed from the parser's events in one loop, so that neither depth nor size of a hostile file costs more than its
length. Left out of YAML on purpose: tags, merge keys, several documents, keys that are not text.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import yaml

from harness.errors import InputError, Problem
from harness.experiment.kind import LARGEST_FILE
from harness.experiment.messages import near, printable, shown
from harness.experiment.scalar import resolve

DEEPEST = 50
MOST_NODES = 250_000  # with every alias written out

KeyPath = tuple[str | int, ...]
Place = tuple[int, int]
# In a path, the last step that means the key itself, not its value. (pydantic's own way to say so.)
KEY = "[key]"

# libyaml where PyYAML was built with it: ten times faster, the same events.
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_UNPRINTABLE = re.compile(r"[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


@dataclass(frozen=True, slots=True)
class Node:
    """A value and where it stands. `children` by key or index; `keys` are the places of a mapping's keys."""

    value: Any
    place: Place
    children: Mapping[str | int, Node] = field(default_factory=dict)
    keys: Mapping[str, Place] = field(default_factory=dict)
    size: int = 1
    height: int = 1


@dataclass(frozen=True)
class Document:
    """The values of a file, and the places they came from.

    Parameters
    ----------
    file : the name that problems are reported under
    root : the composed tree
    problems : what was wrong that did not keep the rest from being read
    """

    file: str
    root: Node
    problems: tuple[Problem, ...] = ()

    @property
    def value(self) -> Any:
        """Plain dicts, lists and scalars. Aliases share their objects: not to be changed."""
        return self.root.value

    def place(self, path: Sequence[str | int]) -> Place:
        """Line and column of the value at a key path, or of the closest thing around it that the file has.

        Steps that are not in the file are passed over; a last step `KEY` asks for the key instead of its value.
        """
        node, place = self.root, self.root.place
        for step in path:
            if step == KEY:
                return place
            if step in node.children:
                place = node.keys.get(str(step), node.children[step].place)
                node = node.children[step]
        return node.place

    def problem(self, path: Sequence[str | int], message: str) -> Problem:
        """A problem with the value at a key path."""
        return Problem(message, self.file, *self.place(path))


def read_document(text: str | bytes, file: str) -> Document:
    """Read the text of an experiment: one mapping.

    Raises
    ------
    InputError
        If the text cannot be read at all: not UTF-8, not YAML, too large or too deep, no mapping.
    """
    document = _compose(_decode(text, file), file)
    if document is None:
        raise InputError([Problem("the file is empty; `harness new NAME` writes one to start from", file, 1, 1)])
    if not isinstance(document.value, dict):
        wrong = document.problem((), f"an experiment must be a mapping of keys to values, not {shown(document.value)}")
        raise InputError([*document.problems, wrong])
    return document


def read_value(text: str) -> Any:
    """The value of a piece of YAML, such as `1/60`, `[5, 10]` or `{uniform: [0, 1]}`.

    Raises
    ------
    InputError
        If it is no YAML; without places, for there is no file.
    """
    try:
        document = _compose(_decode(text, ""), "")
    except InputError as error:
        raise _without_places(error.problems) from None
    if document is None:
        return None
    if document.problems:
        raise _without_places(document.problems)
    return document.value


def _without_places(problems: Sequence[Problem]) -> InputError:
    return InputError([Problem(problem.message) for problem in problems])


def _decode(text: str | bytes, file: str) -> str:
    if len(text) > LARGEST_FILE:
        raise InputError([Problem(f"the file is larger than {LARGEST_FILE // 1_000_000} MB", file, 1, 1)])
    text = (text if isinstance(text, str) else _utf8(text, file)).removeprefix("\ufeff")
    if found := _UNPRINTABLE.search(text):
        message = f"the character U+{ord(found[0]):04X} is not allowed; YAML is printable text"
        raise InputError([Problem(message, file, *_place_of(text[: found.start()]))])
    return text


def _utf8(text: bytes, file: str) -> str:
    try:
        return text.decode("utf-8")
    except UnicodeDecodeError as error:
        place = _place_of(text[: error.start].decode("utf-8"))
        raise InputError([Problem("the file is not UTF-8 text", file, *place)]) from None


def _place_of(before: str) -> Place:
    return before.count("\n") + 1, len(before) - before.rfind("\n")


def _compose(text: str, file: str) -> Document | None:
    composer = _Composer(file)
    try:
        for event in yaml.parse(text, Loader=_LOADER):
            composer.take(event)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = _mark(mark) if mark else (1, 1)
        composer.stop(_syntax(error), place)
    except yaml.YAMLError as error:
        composer.stop(f"this is not YAML: {error}", (1, 1))
    return composer.document()


@dataclass
class _Open:
    """A collection whose end has not come yet."""

    value: dict[str, Any] | list[Any]
    place: Place
    anchor: str | None
    children: dict[str | int, Node] = field(default_factory=dict)
    keys: dict[str, Place] = field(default_factory=dict)
    key: tuple[str | None, Place] | None = None  # the key whose value comes next; its text is None where refused
    size: int = 1
    height: int = 1


class _Composer:
    """Builds the tree from events, depth-first, on a stack of its own."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.problems: list[Problem] = []
        self.stack: list[_Open] = []
        self.anchors: dict[str, Node] = {}
        self.root: Node | None = None
        self.nodes = 0

    def document(self) -> Document | None:
        return Document(self.file, self.root, tuple(self.problems)) if self.root is not None else None

    def stop(self, message: str, place: Place) -> None:
        raise InputError([*self.problems, Problem(message, self.file, *place)])

    def add_problem(self, message: str, place: Place) -> None:
        self.problems.append(Problem(message, self.file, *place))

    def take(self, event: yaml.Event) -> None:
        place = _mark(event.start_mark)
        if isinstance(event, yaml.DocumentStartEvent):
            if self.root is not None:
                self.stop("a second document starts here; an experiment is one document", place)
        elif isinstance(event, yaml.AliasEvent):
            self._alias(str(event.anchor), place)
        elif isinstance(event, yaml.ScalarEvent):
            self._scalar(event, place)
        elif isinstance(event, yaml.CollectionStartEvent):
            self._tag(event.tag, place)
            if len(self.stack) >= DEEPEST:
                self.stop(f"this is nested more than {DEEPEST} deep", place)
            empty: dict[str, Any] | list[Any] = {} if isinstance(event, yaml.MappingStartEvent) else []
            self.stack.append(_Open(empty, place, event.anchor))
        elif isinstance(event, yaml.CollectionEndEvent):
            ended = self.stack.pop()
            node = Node(ended.value, ended.place, ended.children, ended.keys, ended.size, ended.height)
            self._add(node, ended.anchor, node.place)

    def _scalar(self, event: yaml.ScalarEvent, place: Place) -> None:
        self._tag(event.tag, place)
        value: Any = event.value
        if event.implicit[0]:
            try:
                value = resolve(value)
            except ValueError as error:
                self.add_problem(printable(str(error)), place)
                value = 1.0
        if isinstance(value, str) and any(unicodedata.category(c) in ("Cc", "Cs") and c not in "\n\t" for c in value):
            self.add_problem("this text holds a control character", place)
            value = "?"
        if value == "<<" and event.implicit[0] and self._awaits_key():
            self.stop("merge keys (<<) are not supported; write the keys out", place)
        if self._awaits_key() and not isinstance(value, str):
            self.add_problem(f'a key must be text; put it in quotes: "{printable(event.value)}"', place)
        self._add(Node(value, place), event.anchor, place)

    def _alias(self, anchor: str, place: Place) -> None:
        name = printable(anchor)
        if anchor not in self.anchors:
            if any(opened.anchor == anchor for opened in self.stack):
                self.stop(f"*{name} refers to the value it stands in", place)
            self.stop(f"*{name} refers to nothing{near(anchor, self.anchors)}", place)
        self._add(self.anchors[anchor], None, place, count=self.anchors[anchor].size)

    def _tag(self, tag: str | None, place: Place) -> None:
        if tag is not None:
            self.add_problem(f"tags such as {shown(tag)} are not allowed", place)

    def _awaits_key(self) -> bool:
        return bool(self.stack) and isinstance(self.stack[-1].value, dict) and self.stack[-1].key is None

    def _add(self, node: Node, anchor: str | None, place: Place, count: int = 1) -> None:
        self.nodes += count
        if self.nodes > MOST_NODES:
            self.stop(f"more than {MOST_NODES} values, aliases written out, are too many", place)
        if len(self.stack) + node.height > DEEPEST + 1:
            self.stop(f"this is nested more than {DEEPEST} deep, aliases written out", place)
        if anchor is not None:
            self.anchors[anchor] = node
        if not self.stack:
            self.root = node
            return
        parent = self.stack[-1]
        parent.size += node.size
        parent.height = max(parent.height, node.height + 1)
        if isinstance(parent.value, list):
            parent.children[len(parent.value)] = node
            parent.value.append(node.value)
        elif parent.key is None:
            self._begin_key(parent, node, place)
        else:
            key, key_place = parent.key
            parent.key = None
            if key is not None:
                parent.value[key] = node.value
                parent.children[key] = node
                parent.keys[key] = key_place

    def _begin_key(self, parent: _Open, node: Node, place: Place) -> None:
        key: str | None = node.value if isinstance(node.value, str) else None
        if isinstance(node.value, dict | list):
            self.add_problem("a key must be text", place)
        if key is not None and key in parent.keys:
            self.add_problem(f"duplicate key {shown(key)}; the first is in line {parent.keys[key][0]}", place)
            key = None
        parent.key = (key, place)


def _mark(mark: Any) -> Place:
    return mark.line + 1, mark.column + 1


# The most frequent mistakes, in plain words: text that both parsers have in their messages -> the message of ours.
_HINTS = {
    "mapping values are not allowed": 'a ": " stands where no key can be: mend the indentation, or quote the text',
    "found character '\\t'": "a tab cannot indent; use spaces",
    "that cannot start any token": "no value can start with this character: put text in quotes, and indent with spaces",
    "block sequence entries are not allowed": 'a "- " stands where no list can be: mend the indentation',
    "unexpected end of stream": "a quotation mark is never closed",
    "<stream end>": "the file ends before what was begun is closed",
}


def _syntax(error: yaml.MarkedYAMLError) -> str:
    problem = error.problem or "unreadable"
    for sign, hint in _HINTS.items():
        if sign in problem:
            return f"this is not YAML: {hint}"
    context = f" ({error.context})" if error.context else ""
    return f"this is not YAML: {problem}{context}"
