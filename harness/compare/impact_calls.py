"""How each library is asked when two moving bodies meet, in a few lines of Python that need nothing else.

Beside the names of `library_calls` there are `V`, `W` and `X`, `Y`, the bodies' velocities and spins, and `DURATION`;
`moved` tells where a body is after a time, and how it is turned. The first body spins no faster than the second.
"""

from __future__ import annotations

from dataclasses import replace

from harness.compare.library_calls import CALLS, Call, ended_by
from harness.vocabulary import Shape

_FCL = """\
parts = {parts}
times = np.linspace(0, DURATION, parts + 1)
for start, end in zip(times, times[1:]):
    one, other = body(A, FACES_A, *moved(P, Q, V, W, start)), body(B, FACES_B, *moved(R, S, X, Y, start))
    ends = [fcl.Transform(turn, place) for place, turn in (moved(P, Q, V, W, end), moved(R, S, X, Y, end))]
    request, result = fcl.ContinuousCollisionRequest({request}), fcl.ContinuousCollisionResult()
    fcl.continuousCollide(one, ends[0], other, ends[1], request, result)
    if result.is_collide:
        return start + (end - start) * result.time_of_contact
"""
_FCL_HULL = _FCL.format(
    parts="max(1, int(np.ceil(max(np.linalg.norm(W), np.linalg.norm(Y)) * DURATION)))  # turns of at most 1 rad",
    request="\n        ccd_motion_type=fcl.CCDMotionType.CCDM_LINEAR,"
    "\n        ccd_solver_type=fcl.CCDSolverType.CCDC_CONSERVATIVE_ADVANCEMENT",
)
_FCL_MESH = _FCL.format(
    parts="1",
    request="\n        num_max_iterations=100, toc_err=0.01, ccd_motion_type=fcl.CCDMotionType.CCDM_TRANS,"
    "\n        ccd_solver_type=fcl.CCDSolverType.CCDC_NAIVE",
)
_RAPIER = """
colliders, bodies = rapier3d.ColliderSet(), rapier3d.RigidBodySet()
one, other = [rapier3d.SharedShape.{make} for vertices, faces in ((A, FACES_A), (B, FACES_B))]
colliders.insert(rapier3d.Collider.new(one))
world = rapier3d.QueryPipeline(rapier3d.BroadPhaseBvh(), rapier3d.NarrowPhase(), bodies, colliders)
world.update(bodies, colliders)
parts = max(1, int(np.ceil(np.linalg.norm(W) * DURATION / 0.02)))  # in which the one at rest turns by no more
vector, options = rapier3d.Vec3, rapier3d.ShapeCastOptions()
options.max_time_of_impact = length = DURATION / parts
for start in np.arange(parts) * length:  # the other's motion in the axes of the first
    (place, turn), (at, facing) = moved(P, Q, V, W, start), moved(R, S, X, Y, start)
    back = turn * [1, -1, -1, -1]
    way = np.subtract(X, V) - np.cross(W, at - place)
    begin, way, spin = [times(times(back, [0, *v]), turn)[1:] for v in (at - place, way, np.subtract(Y, W))]
    motion = rapier3d.NonlinearRigidMotion(
        start=rapier3d.Isometry3(vector(*begin), rapier3d.Rotation3(*times(back, facing))),
        local_center=[0.0, 0.0, 0.0], linvel=vector(*way), angvel=vector(*spin))
    hit = world.cast_shape_nonlinear(motion, other, options, 0.0, length)
    if hit is not None:
        return start + hit[1].time_of_impact
"""


IMPACT_CALLS: dict[tuple[str, Shape], Call] = {
    ("fcl", "hull"): ended_by(CALLS["fcl", "hull"], "return fcl.collide", _FCL_HULL),
    ("fcl", "mesh"): ended_by(CALLS["fcl", "mesh"], "return fcl.collide", _FCL_MESH),
    ("rapier3d", "hull"): replace(CALLS["rapier3d", "hull"], ask=_RAPIER.format(make="convex_hull(vertices.tolist())")),
    ("rapier3d", "mesh"): replace(
        CALLS["rapier3d", "mesh"], ask=_RAPIER.format(make="trimesh(vertices.tolist(), faces.tolist())")
    ),
}
"""Those that tell times of impact, by backend and shape. What they return is s, or None for never."""
