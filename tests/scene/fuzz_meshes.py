"""Changes mesh files at random and inspects each: none may crash, hang, take too much memory or speak as code does.

    python tests/scene/fuzz_meshes.py [TRIES] [FORMAT...]

TRIES (default 10 000) files of each format are made from those of `mesh_tables` by changing, inserting, repeating and
cutting bytes, words and lines, and are read as `harness mesh inspect` reads them, many by one limited child.
"""

from __future__ import annotations

import random
import re
import resource
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from harness.cli.mesh import _facts
from harness.scene.formats import FORMATS
from harness.scene.mesh_child import GIB, open_meshes
from tests.scene.mesh_samples import CUBE, MIXED, RING, L, U, obj, off, ply, stl_text
from tests.scene.mesh_tables import READ, REFUSED

MEMORY = 4 * GIB
SECONDS = 10.0
BATCH = 250
WORDS = (
    b"0 1 -1 -9 2 8 9 255 256 65536 2147483648 -2147483649 4294967296 99999999999999999999 1e9 1e38 1e39 1e-39 1e308 "
    b"1e309 -1e308 nan inf 0x10 1_0 1.5 .5 1. - + / // 1/ /1 1//1 # \\ v f vn facet vertex endfacet solid list uchar "
    b'double element property end_header OFF COFF ply null true [] {} "" -0'
).split()
# What a person must not be shown: a library's or Python's own words.
INNER = re.compile(
    r"Error|Exception|Traceback|to unpack|kwarg|dtype|ndarray|broadcast|NoneType|\bobject\b|0x[0-9a-f]{6}|index \d"
)
FAILURES = {
    "crashed": "reading it crashed",
    "killed": "reading it was killed",
    "left": "the reader ended without an answer",
    "hung": "reading it took longer",
    "memory": "GiB of memory",
}


@dataclass
class Tally:
    """What became of the tries of one format, and the files with which something went wrong."""

    outcomes: Counter[str] = field(default_factory=Counter)
    reasons: Counter[str] = field(default_factory=Counter)
    failures: list[tuple[str, bytes]] = field(default_factory=list)
    slowest: float = 0.0


def fuzz(form: str, tries: int, seed: int = 0) -> Tally:
    """Read so many changed files of a format."""
    chance = random.Random(f"{form} {seed}")
    samples = samples_of(form)
    tally = Tally()
    for start in range(0, tries, BATCH):
        with tempfile.TemporaryDirectory(prefix="harness-fuzz-") as folder:
            contents = {}
            for number in range(start, min(start + BATCH, tries)):
                path = Path(folder) / f"{number}.{form}"
                contents[path] = changed(chance.choice(samples), chance, samples)
                path.write_bytes(contents[path])
            begun = time.monotonic()
            opened = open_meshes(list(contents), MEMORY, SECONDS)
            tally.slowest = max(tally.slowest, time.monotonic() - begun)
            for path, mesh in opened.items():
                outcome = "read"
                if isinstance(mesh, str):
                    reason = mesh.removeprefix(f"{path.name}: ")
                    outcome = next((name for name, text in FAILURES.items() if text in reason), "refused")
                    if INNER.search(re.sub(r'"[^"]*"', "", reason)) or not reason.isprintable() or reason == mesh:
                        outcome = "inner words"
                    tally.reasons[re.sub(r'"[^"]*"|[-+.\de]*\d', "…", reason)] += 1
                else:
                    _facts(mesh)
                tally.outcomes[outcome] += 1
                if outcome not in ("read", "refused"):
                    tally.failures.append((str(mesh), contents[path]))
    return tally


def samples_of(form: str) -> list[bytes]:
    """Whole files of a format, which changes start from."""
    whole = 5 * [row[2] for row in READ if row[0].endswith(form)]
    whole += [row[2] for row in REFUSED if row[0].endswith(form) and row[2]]
    solids = (CUBE, MIXED, L, U, RING)
    if form == "ply":
        whole += [ply(solid, order) for solid in solids for order in ("", "<", ">")]
    elif form in ("obj", "off", "stl"):
        whole += [{"obj": obj, "off": off, "stl": stl_text}[form](solid) for solid in solids]
    return whole


def changed(content: bytes, chance: random.Random, others: list[bytes]) -> bytes:
    """A file with one change or a few."""
    for _ in range(chance.choice((1, 1, 1, 1, 2, 6))):
        content = chance.choice(CHANGES)(content, chance, others)
    data = content.find(b"BIN\0")
    if content.startswith(b"glTF") and data > 24 and chance.random() < 0.8:  # else hardly one would be looked into
        lengths = len(content).to_bytes(4, "little"), (data - 24).to_bytes(4, "little")
        content = content[:8] + lengths[0] + lengths[1] + content[16:]
    return content


def _byte(content: bytes, chance: random.Random, others: list[bytes]) -> bytes:
    place = chance.randrange(len(content) + 1)
    return content[:place] + chance.randbytes(chance.choice((0, 1, 1, 4))) + content[place + chance.choice((0, 1, 4)) :]


def _bit(content: bytes, chance: random.Random, others: list[bytes]) -> bytes:
    if not content:
        return content
    place = (
        chance.randrange(len(content) // 2, len(content)) if chance.random() < 0.5 else chance.randrange(len(content))
    )
    return content[:place] + bytes([content[place] ^ 1 << chance.randrange(8)]) + content[place + 1 :]


def _integer(content: bytes, chance: random.Random, others: list[bytes]) -> bytes:
    place = chance.randrange(len(content) + 1)
    number = chance.choice((0, 1, 2**15, 2**16 - 1, 2**31 - 1, 2**31, 2**32 - 1, 0x7F800000, 0x7FC00000, 1000, 10**6))
    return content[:place] + number.to_bytes(4, chance.choice(("little", "big"))) + content[place + 4 :]


def _word(content: bytes, chance: random.Random, others: list[bytes]) -> bytes:
    words = list(re.finditer(rb"[^\s,:\[\]{}\"]+", content))
    if not words:
        return content
    word = chance.choice(words)
    if chance.random() < 0.5:  # by another of the same file, which is more likely to make sense there
        return content[: word.start()] + chance.choice(words)[0] + content[word.end() :]
    return content[: word.start()] + chance.choice(WORDS) + content[word.end() :]


def _lines(content: bytes, chance: random.Random, others: list[bytes]) -> bytes:
    lines = content.splitlines(keepends=True) or [b""]
    first, second = chance.randrange(len(lines)), chance.randrange(len(lines))
    match chance.randrange(4):
        case 0:
            lines[first], lines[second] = lines[second], lines[first]
        case 1:
            del lines[first]
        case 2:
            lines[first:first] = lines[first : first + 1] * chance.choice((1, 2, 50))
        case _:
            lines.insert(first, chance.choice(chance.choice(others).splitlines(keepends=True) or [b""]))
    return b"".join(lines)


def _cut(content: bytes, chance: random.Random, others: list[bytes]) -> bytes:
    return content[: chance.randrange(len(content) + 1)]


def _joined(content: bytes, chance: random.Random, others: list[bytes]) -> bytes:
    other = chance.choice(others)
    return content[: chance.randrange(len(content) + 1)] + other[chance.randrange(len(other)) :]


CHANGES = (_byte, _bit, _bit, _bit, _integer, _word, _word, _word, _lines, _lines, _cut, _joined)


def main() -> int:
    """Fuzz all formats or those that are named; returns 1 if anything went wrong."""
    tries = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    failed = 0
    for form in sys.argv[2:] or FORMATS:
        tally = fuzz(form, tries)
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
        print(f"{form}: {dict(tally.outcomes)}, at most {tally.slowest:.0f} s for {BATCH} files, peak {peak:.0f} MiB")
        for reason, count in tally.reasons.most_common(20):
            print(f"  {count:6} {reason}")
        for message, content in tally.failures[:20]:
            print(f"  FAILED {message}\n    {content[:400]!r}")
        failed += len(tally.failures)
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
