"""From a point of an experiment to the scene it declares: everything random is drawn here, from the point's seed."""

from __future__ import annotations

import numpy as np

from harness.arrays import Floats, Ints
from harness.experiment.experiment import Point
from harness.scene.bodies import Bodies
from harness.scene.box import Box
from harness.scene.launch import directions, orientations, place
from harness.scene.mesh import Mesh
from harness.scene.recorded_poses import RecordedPoses
from harness.scene.scene import Scene
from harness.scene.scene_files import SceneFiles

# The most sizes drawn to compute the packing of a scene; of more bodies, a sample is drawn.
MOST_DRAWN = 10**6
# Bytes that a body needs at the least, for poses, velocities and neighbours: enough to refuse what cannot fit.
BYTES_A_BODY = 500


class SceneSizeError(Exception):
    """The scene would need more memory than the run may use."""


def build_scene(point: Point, files: SceneFiles, memory: int | None = None) -> Scene:
    """The scene of a point.

    Parameters
    ----------
    point : Point
    files : that it names
    memory : B the run may use; more is refused before anything is allocated

    Raises
    ------
    SceneSizeError
    PlacementError
        If the bodies do not fit into the box.

    Notes
    -----
    Sizes, places, orientations, directions, speeds, spins and meshes are drawn from streams of their own, so that
    changing the distribution of one leaves the others as they were.
    """
    count = body_count(point)
    _refuse_too_large(count, memory)
    mesh_of = _mesh_numbers(point, count)
    if files.poses is not None:
        return _recorded(point, files, files.poses, mesh_of)
    bodies = _launched(point, files, mesh_of) if point.scene.bodies is None else _explicit(point, files, mesh_of)
    meshes, mesh_of = _of_bodies(files.meshes, mesh_of)
    return Scene(
        point.scene.shape,
        meshes,
        bodies,
        box_of(point, files),
        mesh_of=mesh_of,
        ignored=_ignored(point),
        apart=point.scene.bodies is None and point.scene.overlap == "reject",
    )


def _recorded(point: Point, files: SceneFiles, poses: RecordedPoses, mesh_of: Ints) -> Scene:
    """A scene whose poses are recorded, in the frames of the mesh files; this program's are those of the centres."""
    explicit = point.scene.bodies is not None
    sizes = _explicit_sizes(point, files, mesh_of) if explicit else _sizes(point, files, mesh_of)
    offsets = np.zeros((len(mesh_of), 3))
    if files.meshes:
        scales = sizes / _diameters(files.meshes)[mesh_of]
        offsets = np.array([mesh.centre for mesh in files.meshes])[mesh_of] * scales[:, None]
    centres = poses.of_centres(offsets)
    bodies = centres.at_start(sizes, sizes**3)
    # twice as wide as it must be, so that no rounding brings a body to a wall
    box = Box(2.0 * centres.half_box(bodies.radii))
    meshes, mesh_of = _of_bodies(files.meshes, mesh_of)
    return Scene(point.scene.shape, meshes, bodies, box, mesh_of=mesh_of, ignored=_ignored(point), poses=centres)


def mesh_count(point: Point) -> int:
    """How many different meshes the bodies of a point have: a mesh that is named may be that of none.

    Of a million bodies and more the first million.
    """
    names, count = point.scene.mesh_names, min(body_count(point), MOST_DRAWN)
    if len(names) < 2 or not count:
        return len(names)
    return len(np.unique(_mesh_numbers(point, count)))


def _of_bodies(meshes: tuple[Mesh, ...], mesh_of: Ints) -> tuple[tuple[Mesh, ...], Ints]:
    """The meshes that a body has, and each body's among them: one that none has needs no stage of a plan."""
    if len(meshes) < 2 or not len(mesh_of):
        return meshes, mesh_of
    had, numbers = np.unique(mesh_of, return_inverse=True)
    return tuple(meshes[number] for number in had), numbers


def body_count(point: Point) -> int:
    """How many bodies a point has."""
    return (point.scene.count or 0) if point.scene.bodies is None else len(point.scene.bodies)


def box_of(point: Point, files: SceneFiles) -> Box:
    """The box of a point: as given, or a cube by its ratio (mean size / side)² to the bodies."""
    if point.scene.box is not None:
        return Box(np.array(point.scene.box) / 2)
    assert point.scene.box_ratio is not None, "the schema asks for a box or a box_ratio"
    side = mean_size(point, files) / np.sqrt(point.scene.box_ratio)
    return Box(np.full(3, side / 2))


def derived_parameters(point: Point, files: SceneFiles) -> dict[str, float]:
    """`faces`, `hull_vertices`, `packing` and `box_side` of a point, without placing its bodies.

    Of recorded poses `duration` and `dt` (the mean) instead of the last two.

    Packing is that of the sizes really drawn, of a million bodies and more that of the first million; so are the
    faces and vertices of several meshes, which are means over the bodies.
    """
    count = body_count(point)
    mesh_of = _mesh_numbers(point, min(count, MOST_DRAWN))
    meshes = {
        "faces": _mean([len(mesh.faces) for mesh in files.meshes], mesh_of),
        "hull_vertices": _mean([len(mesh.hull.vertices) for mesh in files.meshes], mesh_of),
    }
    if files.poses is not None:  # there is no box
        span = float(files.poses.time[-1] - files.poses.time[0])
        return {**meshes, "duration": span, "dt": span / (len(files.poses) - 1)}
    box = box_of(point, files)
    return {
        **meshes,
        "packing": float(np.pi / 6 * _cubes(point, files, mesh_of) / box.volume),
        "box_side": float(np.cbrt(box.volume)),
    }


def mean_size(point: Point, files: SceneFiles) -> float:
    """The expected size of a body, m."""
    scene = point.scene
    if scene.bodies is not None:
        return float(np.mean(_explicit_sizes(point, files, _mesh_numbers(point, len(scene.bodies)))))
    if scene.size.is_native:
        chosen = [files.meshes[scene.mesh_names.index(name)].diameter for name in scene.mesh_choice]
        return float(np.mean(chosen))
    return float(scene.size.mean)


def _mean(of_mesh: list[int], mesh_of: Ints) -> float:
    """The number of the one mesh, or the mean over the bodies; 0 without a mesh."""
    if len(of_mesh) < 2 or not len(mesh_of):
        return of_mesh[0] if of_mesh else 0
    return float(np.array(of_mesh)[mesh_of].mean())


def _cubes(point: Point, files: SceneFiles, mesh_of: Ints) -> float:
    """m³, the sum of all sizes cubed."""
    scene, count = point.scene, body_count(point)
    if scene.bodies is None and scene.size.kind == "constant":
        return float(count * scene.size.mean**3)
    sizes = _sizes(point, files, mesh_of) if scene.bodies is None else _explicit_sizes(point, files, mesh_of)
    return float((sizes**3).sum()) * (count / max(1, len(sizes)))


def _streams(point: Point) -> dict[str, np.random.Generator]:
    names = ("sizes", "places", "orientations", "directions", "speeds", "axes", "spins", "meshes")
    seeds = np.random.SeedSequence(point.scene.seed).spawn(len(names))
    return {name: np.random.default_rng(seed) for name, seed in zip(names, seeds, strict=True)}


def _mesh_numbers(point: Point, count: int) -> Ints:
    """(count,): the number of each body's mesh among those that the scene names."""
    names, choice, bodies = point.scene.mesh_names, point.scene.mesh_choice, point.scene.bodies
    if len(names) < 2:
        return np.zeros(count, np.int64)
    numbers = np.zeros(count, np.int64)
    if choice:
        chosen = np.array([names.index(name) for name in choice])
        numbers = chosen[_streams(point)["meshes"].integers(len(choice), size=count)]
    for body, given in enumerate(bodies or ()):
        if given.mesh is not None:
            numbers[body] = names.index(given.mesh)
    return numbers


def _sizes(point: Point, files: SceneFiles, mesh_of: Ints) -> Floats:
    """(n,) m, of random bodies."""
    if point.scene.size.is_native:
        return _diameters(files.meshes)[mesh_of]
    return point.scene.size.sample(_streams(point)["sizes"], len(mesh_of))


def _explicit_sizes(point: Point, files: SceneFiles, mesh_of: Ints) -> Floats:
    """(n,) m, of bodies that are given one by one."""
    given = point.scene.bodies or ()
    native = _diameters(files.meshes)[mesh_of] if files.meshes else np.ones(len(given))
    sizes = [size if isinstance(body.size, str) else body.size for body, size in zip(given, native, strict=False)]
    return np.array(sizes, np.float64)


def _diameters(meshes: tuple[Mesh, ...]) -> Floats:
    return np.array([mesh.diameter for mesh in meshes])


def _launched(point: Point, files: SceneFiles, mesh_of: Ints) -> Bodies:
    scene, count, rng = point.scene, len(mesh_of), _streams(point)
    sizes = _sizes(point, files, mesh_of)
    speeds, spins = scene.speed.sample(rng["speeds"], count), scene.spin.sample(rng["spins"], count)
    return Bodies(
        positions=place(sizes / 2, box_of(point, files), rng["places"], overlap=scene.overlap == "allow"),
        velocities=directions(rng["directions"], count) * speeds[:, None],
        quaternions=orientations(rng["orientations"], count),
        spins=directions(rng["axes"], count) * spins[:, None],
        sizes=sizes,
        masses=sizes**3,
    )


def _explicit(point: Point, files: SceneFiles, mesh_of: Ints) -> Bodies:
    bodies = point.scene.bodies or ()
    sizes = _explicit_sizes(point, files, mesh_of)
    quaternions = np.array([body.orientation for body in bodies], np.float64).reshape(-1, 4)
    masses = [size**3 if body.mass is None else body.mass for body, size in zip(bodies, sizes, strict=True)]
    return Bodies(
        positions=np.array([body.position for body in bodies], np.float64).reshape(-1, 3),
        velocities=np.array([body.velocity for body in bodies], np.float64).reshape(-1, 3),
        quaternions=quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True),
        spins=np.array([body.spin for body in bodies], np.float64).reshape(-1, 3),
        sizes=sizes,
        masses=np.array(masses, np.float64),
    )


def _ignored(point: Point) -> Ints:
    """(k, 2): the pairs that are never asked about, i < j, sorted, each once."""
    pairs = np.array(point.scene.ignore, np.int64).reshape(-1, 2)
    ordered: Ints = np.unique(np.sort(pairs, axis=1), axis=0)
    return ordered


def _refuse_too_large(count: int, memory: int | None) -> None:
    if memory is not None and count * BYTES_A_BODY > memory:
        needed, allowed = count * BYTES_A_BODY / 2**30, memory / 2**30
        raise SceneSizeError(
            f"{count} bodies need at least {needed:.3g} GiB, and measure.memory allows {allowed:.3g} GiB"
        )
