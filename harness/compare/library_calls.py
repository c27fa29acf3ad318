"""How each library is asked about two bodies, in a few lines of Python that need nothing else: for reproductions.

The names `A`, `FACES_A`, `P`, `Q` and `B`, `FACES_B`, `R`, `S` are the bodies' vertices, triangles, positions and
quaternions w x y z. A backend without an entry has no reproductions of its own; its experiments show the same.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from harness.arrays import Floats
from harness.narrowphase.units import unit_of, unit_of_smallest
from harness.vocabulary import Shape


@dataclass(frozen=True)
class Call:
    """A library.

    Parameters
    ----------
    library : its name as a package
    version : an expression for its version
    imports : lines
    ask : the body of a function that returns whether the two touch, or how far they are apart
    unit : m, the length that is told of as 1, for bodies of these sizes (m)
    """

    library: str
    version: str
    imports: str
    ask: str
    unit: Callable[[Floats], float]


_PACKAGE = "version({!r})"
_VERSION = "from importlib.metadata import version\n"

_FCL_HULL = """
def body(vertices, faces, position, quaternion):
    counted = np.column_stack([np.full(len(faces), 3), faces]).ravel()
    return fcl.CollisionObject(fcl.Convex(vertices, len(faces), counted), fcl.Transform(quaternion, position))

return fcl.collide(body(A, FACES_A, P, Q), body(B, FACES_B, R, S)) > 0
"""
_FCL_MESH = """
def body(vertices, faces, position, quaternion):
    model = fcl.BVHModel()
    model.beginModel(len(vertices), len(faces))
    model.addSubModel(vertices, faces)
    model.endModel()
    return fcl.CollisionObject(model, fcl.Transform(quaternion, position))

return fcl.collide(body(A, FACES_A, P, Q), body(B, FACES_B, R, S)) > 0
"""
_COAL = """
def body(vertices, faces, position, quaternion):
    points, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for vertex in vertices:
        points.append(vertex)
    for face in faces.tolist():
        triangles.append(coal.Triangle(*face))
{make}
    turned = coal.Quaternion(*quaternion).toRotationMatrix()
    return coal.CollisionObject(shape, coal.Transform3s(turned, np.array(position)))

request = coal.CollisionRequest()
request.gjk_tolerance = 1e-12
return bool(coal.collide(body(A, FACES_A, P, Q), body(B, FACES_B, R, S), request, coal.CollisionResult()))
"""
_COAL_HULL = "    shape = coal.Convex(points, triangles)"
_COAL_MESH = """    shape = coal.BVHModelOBBRSS()
    shape.beginModel(len(faces), len(vertices))
    shape.addSubModel(points, triangles)
    shape.endModel()"""
_MUJOCO_MODEL = """
spec = mujoco.MjSpec()
{options}
for name, vertices in (("a", A), ("b", B)):
    body = spec.worldbody.add_body()
    body.add_freejoint()
    spec.add_mesh(name=name, uservert=vertices.ravel(), inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX)
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, mass=1.0)
model = spec.compile()
data = mujoco.MjData(model)
data.qpos[:] = [*P, *Q, *R, *S]
"""
_MUJOCO = (
    _MUJOCO_MODEL.format(options="spec.option.ccd_tolerance, spec.option.ccd_iterations = 1e-12, 200")
    + """\
mujoco.mj_kinematics(model, data)
mujoco.mj_collision(model, data)
return data.ncon > 0
"""
)
_MUJOCO_WARP = (
    _MUJOCO_MODEL.format(options="spec.option.ccd_iterations = 200")
    + """\
with warp.ScopedDevice("cpu"):
    kernels, state = mujoco_warp.put_model(model), mujoco_warp.put_data(model, data, nconmax=64, njmax=1)
    mujoco_warp.kinematics(kernels, state)
    mujoco_warp.collision(kernels, state)
    return bool(state.nacon.numpy()[0] > 0)
"""
)
_PYBULLET = """
pybullet.connect(pybullet.DIRECT)
bodies = []
for vertices, place, (w, x, y, z) in ((A, P, Q), (B, R, S)):
    shape = pybullet.createCollisionShape(pybullet.GEOM_MESH, vertices=vertices.tolist())
    bodies.append(pybullet.createMultiBody(1.0, shape, basePosition=place, baseOrientation=[x, y, z, w]))
pybullet.performCollisionDetection()
# the margin of 0.001 inflates each hull
return any(contact[8] + 0.002 <= 0 for contact in pybullet.getContactPoints(*bodies))
"""
_TRIMESH = """
manager = trimesh.collision.CollisionManager()
for name, vertices, faces, place, (w, x, y, z) in (("a", A, FACES_A, P, Q), ("b", B, FACES_B, R, S)):
    pose = trimesh.transformations.quaternion_matrix([w, x, y, z])
    pose[:3, 3] = place
    manager.add_object(name, trimesh.Trimesh(vertices, faces, process=False), pose)
return bool(manager.in_collision_internal())
"""


_PARRY = """
def turned(place, quaternion):
    (w, x, y, z), pose = quaternion, np.eye(4)
    pose[:3, :3] = [[x * x - y * y - z * z + w * w, 2 * (x * y - z * w), 2 * (x * z + y * w)],
                    [2 * (x * y + z * w), -x * x + y * y - z * z + w * w, 2 * (y * z - x * w)],
                    [2 * (x * z - y * w), 2 * (y * z + x * w), -x * x - y * y + z * z + w * w]]
    pose[:3, 3] = place
    return pose
{make}
world = py_parry3d.CollisionWorld([py_parry3d.CollisionGroup(name, [shape]) for name, shape in shapes.items()])
return bool(world.check({{"a": turned(P, Q), "b": turned(R, S)}}, [("a", "b", 0.0)])[0])
"""
_PARRY_HULL = """import trimesh
hull = py_parry3d.ConvexHull_from_trimesh
solids = {"a": trimesh.Trimesh(A, FACES_A, process=False), "b": trimesh.Trimesh(B, FACES_B, process=False)}
shapes = {name: hull(solid) for name, solid in solids.items()}"""
_PARRY_MESH = """mesh = py_parry3d.TriMesh
shapes = {"a": mesh(A, FACES_A.astype("u4")), "b": mesh(B, FACES_B.astype("u4"))}"""
_DRAKE = """
scene, poses = drake.SceneGraph(), drake.FramePoseVector()
source = scene.RegisterSource("bodies")
for name, points, faces, place, turn in (("a", A, FACES_A, P, Q), ("b", B, FACES_B, R, S)):
    lines = ["v %r %r %r" % (*v,) for v in points.tolist()] + ["f %d %d %d" % (*f,) for f in faces + 1]
    mesh = drake.InMemoryMesh(mesh_file=drake.MemoryFile("\\n".join([*lines, ""]), ".obj", "hull"))
    frame = scene.RegisterFrame(source, drake.GeometryFrame(name))
    instance = drake.GeometryInstance(drake.RigidTransform(), drake.Convex(mesh, 1.0), name)
    scene.AssignRole(source, scene.RegisterGeometry(source, frame, instance), drake.ProximityProperties())
    poses.set_value(frame, drake.RigidTransform(drake.Quaternion(turn / np.linalg.norm(turn)), place))
context = scene.CreateDefaultContext()
scene.get_source_pose_port(source).FixValue(context, poses)
return bool(scene.get_query_output_port().Eval(context).ComputePointPairPenetration())
"""
_RAPIER = """
colliders, narrow = rapier3d.ColliderSet(), rapier3d.NarrowPhase()
middle = (np.array(P) + R) / 2  # single precision has few digits to lose
for vertices, faces, place, quaternion in ((A, FACES_A, P, Q), (B, FACES_B, R, S)):
    shape = rapier3d.SharedShape.{make}
    kinds = rapier3d.ActiveCollisionTypes.all()
    collider = rapier3d.Collider.new(shape).sensor(True).active_collision_types(kinds)
    place = rapier3d.Vec3(*(place - middle))
    colliders[colliders.insert(collider)].position = rapier3d.Isometry3(place, rapier3d.Rotation3(*quaternion))
rapier3d.CollisionPipeline().step(
    0.0, rapier3d.IslandManager(), rapier3d.BroadPhaseBvh(), narrow, rapier3d.RigidBodySet(), colliders)
return any(touching for _, _, touching in narrow.intersection_pairs())
"""
_RAPIER_HULL = "convex_hull(vertices.tolist())"
_RAPIER_MESH = "trimesh(vertices.tolist(), faces.tolist())"


def _smallest_32(sizes: Floats) -> float:
    return unit_of_smallest(sizes) / 32.0


def _fcl(ask: str) -> Call:
    return Call("python-fcl", _PACKAGE.format("python-fcl"), f"{_VERSION}import fcl", ask, _smallest_32)


def _coal(make: str) -> Call:
    return Call("coal", "coal.__version__", "import coal", _COAL.format(make=make), unit_of)


def _trimesh() -> Call:
    return Call("trimesh", "trimesh.__version__", "import trimesh", _TRIMESH, _smallest_32)


def _parry(make: str) -> Call:
    return Call(
        "py-parry3d", _PACKAGE.format("py-parry3d"), f"{_VERSION}import py_parry3d", _PARRY.format(make=make), unit_of
    )


def _rapier(make: str) -> Call:
    return Call(
        "rapier3d", _PACKAGE.format("rapier3d"), f"{_VERSION}import rapier3d", _RAPIER.format(make=make), unit_of
    )


CALLS: dict[tuple[str, Shape], Call] = {
    ("fcl", "hull"): _fcl(_FCL_HULL),
    ("fcl", "mesh"): _fcl(_FCL_MESH),
    ("coal", "hull"): _coal(_COAL_HULL),
    ("coal", "mesh"): _coal(_COAL_MESH),
    ("trimesh", "hull"): _trimesh(),
    ("trimesh", "mesh"): _trimesh(),
    ("mujoco", "hull"): Call("mujoco", "mujoco.__version__", "import mujoco", _MUJOCO, unit_of),
    ("mujoco_warp", "hull"): Call(
        "mujoco_warp",
        _PACKAGE.format("mujoco-warp"),
        f"{_VERSION}import mujoco\nimport mujoco_warp\nimport warp",
        _MUJOCO_WARP,
        unit_of,
    ),
    ("drake", "hull"): Call(
        "drake", _PACKAGE.format("drake"), f"{_VERSION}import pydrake.all as drake", _DRAKE, unit_of
    ),
    ("parry3d", "hull"): _parry(_PARRY_HULL),
    ("parry3d", "mesh"): _parry(_PARRY_MESH),
    ("rapier3d", "hull"): _rapier(_RAPIER_HULL),
    ("rapier3d", "mesh"): _rapier(_RAPIER_MESH),
    ("pybullet", "hull"): Call(
        "pybullet", _PACKAGE.format("pybullet"), f"{_VERSION}import pybullet", _PYBULLET, unit_of_smallest
    ),
}
"""By backend and shape."""


def ended_by(call: Call, last: str, instead: str) -> Call:
    """The same call up to a line, and from there on others, which return something else."""
    before, found, _ = call.ask.partition(last)
    if not found:
        raise ValueError(f"the call of {call.library} has no such line: {last}")
    return replace(call, ask=before + instead)


def _asked_for_gap(name: str, shape: Shape, last: str, instead: str) -> Call:
    return ended_by(CALLS[name, shape], last, instead)


_FCL_GAP = """\
one, other = body(A, FACES_A, P, Q), body(B, FACES_B, R, S)
return max(0.0, fcl.distance(one, other, fcl.DistanceRequest(), fcl.DistanceResult()))
"""
_COAL_GAP = """\
request = coal.DistanceRequest()
request.gjk_tolerance = 1e-12
one, other = body(A, FACES_A, P, Q), body(B, FACES_B, R, S)
return max(0.0, coal.distance(one, other, request, coal.DistanceResult()))
"""

_RAPIER_GAP = """\
contacts = [pair.find_deepest_contact() for pair in narrow.contact_pairs()]
return max(0.0, min((contact.dist for contact in contacts if contact is not None), default=np.inf))
"""
# of bodies that are no sensors it tells contacts, ahead of time too, which is all that it tells of gaps
_RAPIER_AHEAD = replace(
    CALLS["rapier3d", "hull"],
    ask=CALLS["rapier3d", "hull"].ask.replace(".sensor(True)", "").replace("    0.0, rapier3d", "    8.0, rapier3d"),
)

GAP_CALLS: dict[tuple[str, Shape], Call] = {
    ("fcl", "hull"): _asked_for_gap("fcl", "hull", "return fcl.collide", _FCL_GAP),
    ("fcl", "mesh"): _asked_for_gap("fcl", "mesh", "return fcl.collide", _FCL_GAP),
    ("coal", "hull"): _asked_for_gap("coal", "hull", "request = coal", _COAL_GAP),
    ("coal", "mesh"): _asked_for_gap("coal", "mesh", "request = coal", _COAL_GAP),
    ("trimesh", "hull"): _asked_for_gap(
        "trimesh", "hull", "return bool", "return max(0.0, manager.min_distance_internal())\n"
    ),
    ("trimesh", "mesh"): _asked_for_gap(
        "trimesh", "mesh", "return bool", "return max(0.0, manager.min_distance_internal())\n"
    ),
    ("mujoco", "hull"): _asked_for_gap(
        "mujoco",
        "hull",
        "mujoco.mj_collision",
        "return max(0.0, mujoco.mj_geomDistance(model, data, 0, 1, 1e6, np.zeros(6)))\n",
    ),
    ("drake", "hull"): _asked_for_gap(
        "drake",
        "hull",
        "return bool",
        "query = scene.get_query_output_port().Eval(context)\n"
        "return max(0.0, query.ComputeSignedDistancePairwiseClosestPoints()[0].distance)\n",
    ),
    ("rapier3d", "hull"): ended_by(_RAPIER_AHEAD, "return any", _RAPIER_GAP),
    ("pybullet", "hull"): _asked_for_gap(
        "pybullet",
        "hull",
        "pybullet.performCollisionDetection",
        "# the margin of 0.001 inflates each hull\n"
        "return max(0.0, min(point[8] for point in pybullet.getClosestPoints(*bodies, 1e3)) + 0.002)\n",
    ),
}
"""Those that tell gaps, by backend and shape."""
