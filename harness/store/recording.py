"""Recorded runs: what a replay shows, as arrays, and how the results file keeps it.

A body flies straight from the beginning of one leg to that of the next, and turns about a fixed axis: the legs, the
first orientations and the spins give every pose at any time exactly.
"""

from __future__ import annotations

import base64
import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.arrays import Floats, Ints, Pairs
from harness.errors import InputError
from harness.store.history import reading
from harness.vocabulary import WALLS


class RecordedMesh(NamedTuple):
    """A mesh whose bounding sphere has its centre at the origin and diameter 1.

    Parameters
    ----------
    digest : equal for equal meshes
    vertices, faces : (v, 3) float array and (f, 3) int32 array
    """

    name: str
    digest: str
    vertices: Floats
    faces: NDArray[np.int32]


class NearLines(NamedTuple):
    """Pairs that were near in the frames of a run, and the nearest points that it found of them.

    Parameters
    ----------
    frames : (k,) int array, ascending; frame f is at f dt
    pairs : (k, 2) body numbers
    points : (k, 2, 3) float array, m, in the world, of the first and of the second body
    """

    frames: Ints
    pairs: Pairs
    points: Floats


@dataclass(frozen=True, eq=False)
class Recording:
    """What a replay shows of one run.

    Parameters
    ----------
    shape : what the narrow phase saw: sphere, hull or mesh
    duration : s
    dt : s a frame; None where no frames were computed
    half_box : (3,) m; None where there is no box, as of recorded poses
    sizes : (n,) m, diameters of bounding spheres
    quaternions, spins : (n, 4) and (n, 3), rad/s; a body is turned by exp(spin t) quaternion
    surfaces : the meshes that bodies have, scaled by their sizes; none for spheres
    surface_of : (n,) which of them each body has
    leg_times, leg_bodies : (m,) s and body numbers, in the order of time; the first n are the bodies at time 0
    leg_positions, leg_velocities : (m, 3) m and m/s
    leg_quaternions, leg_spins : (m, 4) and (m, 3) rad/s where each leg has its own, as of recorded poses; else None
    hit_times, hit_bodies, hit_walls : (k,) s, (k, 2) body numbers, the second -1 at a wall, and (k,) numbers of walls,
        -1 between bodies
    near : of a run that asked which pairs are near
    hit_points : (k, 3) m, where the bodies of a hit touched, nan at walls; of a run that asked when bodies meet
    """

    shape: str
    duration: float
    dt: float | None
    half_box: Floats | None
    sizes: Floats
    quaternions: Floats
    spins: Floats
    surfaces: tuple[RecordedMesh, ...]
    surface_of: Ints
    leg_times: Floats
    leg_bodies: Ints
    leg_positions: Floats
    leg_velocities: Floats
    hit_times: Floats
    hit_bodies: Pairs
    hit_walls: Ints
    near: NearLines | None = None
    hit_points: Floats | None = None
    leg_quaternions: Floats | None = None
    leg_spins: Floats | None = None

    def __len__(self) -> int:
        return len(self.sizes)


# Columns of the numbers of a body, and of those of a leg; the last two are there where each leg turns in its own way.
_SIZE, _QUATERNION, _SPIN = 0, slice(1, 5), slice(5, 8)
_BODY_COLUMNS = 8
_LEG_BODY, _POSITION, _VELOCITY, _LEG_QUATERNION, _LEG_SPIN = 0, slice(1, 4), slice(4, 7), slice(7, 11), slice(11, 14)
_LEG_COLUMNS, _TURNING_LEG_COLUMNS = 7, 14


def write(connection: sqlite3.Connection, run: int, recording: Recording) -> None:
    """Keep the recording of a run, inside the caller's transaction."""
    facts: dict[str, Any] = {
        "shape": recording.shape,
        "duration": recording.duration,
        "dt": recording.dt,
        "turning_legs": recording.leg_quaternions is not None,
        "half_box": None if recording.half_box is None else recording.half_box.tolist(),
        **_facts_of_query(recording),
    }
    digests = [surface.digest for surface in recording.surfaces]
    if len(digests) > 1:
        facts |= {"meshes": digests, "mesh_of": recording.surface_of.tolist()}
    for surface in recording.surfaces:
        connection.execute(
            "INSERT INTO mesh (digest, name, vertices, faces) VALUES (?, ?, ?, ?) ON CONFLICT (digest) DO NOTHING",
            (
                surface.digest,
                surface.name,
                surface.vertices.astype("<f8").tobytes(),
                surface.faces.astype("<i4").tobytes(),
            ),
        )
    bodies = np.column_stack([recording.sizes, recording.quaternions, recording.spins])
    connection.execute(
        "INSERT INTO recording (run, facts, bodies, mesh) VALUES (?, ?, ?, ?)",
        (run, json.dumps(facts), bodies.astype("<f8").tobytes(), digests[0] if digests else None),
    )
    connection.executemany(
        "INSERT INTO event (run, place, time, kind, first, second, wall) VALUES (?, ?, ?, ?, ?, ?, ?)",
        ((run, place, *hit) for place, hit in enumerate(_hits(recording))),
    )
    columns = [recording.leg_bodies, recording.leg_positions, recording.leg_velocities]
    if recording.leg_quaternions is not None and recording.leg_spins is not None:
        columns += [recording.leg_quaternions, recording.leg_spins]
    legs = np.column_stack(columns).astype("<f8")
    moments = groupby(range(len(legs)), key=lambda leg: float(recording.leg_times[leg]))
    connection.executemany(
        "INSERT INTO frame (run, place, time, data) VALUES (?, ?, ?, ?)",
        ((run, place, time, legs[list(rows)].tobytes()) for place, (time, rows) in enumerate(moments)),
    )


def _facts_of_query(recording: Recording) -> dict[str, Any]:
    """What other queries than collision add, in base64; a file has no tables for it."""
    facts: dict[str, Any] = {}
    if recording.near is not None:
        facts["near"] = {name: _packed(values) for name, values in recording.near._asdict().items()}
    if recording.hit_points is not None:
        facts["hit_points"] = _packed(recording.hit_points)
    return facts


def _packed(values: NDArray[Any]) -> str:
    kind = "<f8" if np.issubdtype(values.dtype, np.floating) else "<i8"
    return base64.b64encode(np.ascontiguousarray(values, kind).tobytes()).decode("ascii")


def _unpacked(text: str, kind: str, *shape: int) -> NDArray[Any]:
    return np.frombuffer(base64.b64decode(text), kind).reshape(-1, *shape)


def _hits(recording: Recording) -> Iterator[tuple[float, str, int, int | None, str | None]]:
    """Rows of the table `event`: time, kind, first, second, wall."""
    columns = (recording.hit_times, recording.hit_bodies, recording.hit_walls)
    for time, (i, j), wall in zip(*(column.tolist() for column in columns), strict=True):
        yield (time, "pair", i, j, None) if wall < 0 else (time, "wall", i, None, WALLS[wall])


def recorded(connection: sqlite3.Connection, keys: Iterable[str]) -> set[str]:
    """The keys, of those given, whose points have a recording."""
    return {
        key
        for (key,) in connection.execute(
            "SELECT key FROM recording JOIN run ON run.id = recording.run JOIN point ON point.id = run.point "
            "WHERE key IN (SELECT value FROM json_each(?))",
            (json.dumps(list(keys)),),
        )
    }


class PointRecording(NamedTuple):
    """A recording, and the point it is of: its key, its parameters and the counters of its run."""

    point: str
    parameters: Mapping[str, Any]
    counters: Mapping[str, float]
    recording: Recording


def recording_of(path: str | Path, experiment: str) -> PointRecording | None:
    """The newest recording of a point that an experiment lists now; None where nothing was recorded.

    Raises
    ------
    InputError
        The file is missing, empty, damaged, another program's, or of another schema version.
    """
    with reading(path) as connection:
        row = connection.execute(
            "SELECT recording.run, key, parameters, facts, bodies, mesh FROM recording "
            "JOIN run ON run.id = recording.run JOIN point ON point.id = run.point "
            "JOIN experiment_point ON experiment_point.point = point.id "
            "JOIN experiment ON experiment.id = experiment_point.experiment "
            "WHERE experiment.name = ? ORDER BY recording.run DESC LIMIT 1",
            (experiment,),
        ).fetchone()
        if row is None:
            return None
        run, key, parameters, facts, bodies, digest = row
        counters = dict(
            connection.execute(
                "SELECT name, value FROM metric WHERE run = ? AND unit = '1' AND value IS NOT NULL ORDER BY rowid",
                (run,),
            )
        )
        try:
            recording = _read(connection, run, json.loads(facts), bodies, digest)
        except (ValueError, LookupError, TypeError) as error:
            raise InputError(
                f"{path}: is damaged: the recording of run {run} cannot be read. Sweep into another file with --db"
            ) from error
        return PointRecording(key, json.loads(parameters), counters, recording)


def _read(
    connection: sqlite3.Connection, run: int, facts: Mapping[str, Any], bodies: bytes, digest: str | None
) -> Recording:
    hits = connection.execute(
        "SELECT time, first, coalesce(second, -1), wall FROM event WHERE run = ? ORDER BY place", (run,)
    ).fetchall()
    frames = connection.execute("SELECT time, data FROM frame WHERE run = ? ORDER BY place", (run,)).fetchall()
    turning = bool(facts.get("turning_legs"))
    width = _TURNING_LEG_COLUMNS if turning else _LEG_COLUMNS
    legs = [np.frombuffer(data, "<f8").reshape(-1, width) for _, data in frames]
    rows = np.concatenate([*legs, np.empty((0, width))])
    each = np.frombuffer(bodies, "<f8").reshape(-1, _BODY_COLUMNS)
    if set(rows[:, _LEG_BODY]) != set(range(len(each))):
        raise ValueError("bodies without a leg, or legs without a body")
    digests = facts.get("meshes", [] if digest is None else [digest])
    return Recording(
        shape=facts["shape"],
        duration=facts["duration"],
        dt=facts["dt"],
        half_box=None if facts["half_box"] is None else np.array(facts["half_box"]),
        sizes=each[:, _SIZE],
        quaternions=each[:, _QUATERNION],
        spins=each[:, _SPIN],
        surfaces=tuple(_surface(connection, name) for name in digests),
        surface_of=np.array(facts.get("mesh_of", [0] * len(each)), np.int64),
        leg_times=np.repeat([time for time, _ in frames], [len(leg) for leg in legs]).astype(np.float64),
        leg_bodies=rows[:, _LEG_BODY].astype(np.int64),
        leg_positions=rows[:, _POSITION],
        leg_velocities=rows[:, _VELOCITY],
        hit_times=np.array([time for time, *_ in hits], np.float64),
        hit_bodies=np.array([(i, j) for _, i, j, _ in hits], np.int64).reshape(-1, 2),
        hit_walls=np.array([-1 if wall is None else WALLS.index(wall) for *_, wall in hits], np.int64),
        near=_near_lines(facts["near"]) if "near" in facts else None,
        hit_points=_unpacked(facts["hit_points"], "<f8", 3) if "hit_points" in facts else None,
        leg_quaternions=rows[:, _LEG_QUATERNION] if turning else None,
        leg_spins=rows[:, _LEG_SPIN] if turning else None,
    )


def _near_lines(packed: Mapping[str, str]) -> NearLines:
    return NearLines(
        _unpacked(packed["frames"], "<i8"),
        _unpacked(packed["pairs"], "<i8", 2),
        _unpacked(packed["points"], "<f8", 2, 3),
    )


def _surface(connection: sqlite3.Connection, digest: str) -> RecordedMesh:
    name, vertices, faces = connection.execute(
        "SELECT name, vertices, faces FROM mesh WHERE digest = ?", (digest,)
    ).fetchone()
    return RecordedMesh(
        name, digest, np.frombuffer(vertices, "<f8").reshape(-1, 3), np.frombuffer(faces, "<i4").reshape(-1, 3)
    )
