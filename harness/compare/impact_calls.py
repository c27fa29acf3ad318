"""How each library is asked when two moving bodies meet, in a few lines of Python that need nothing else.

Beside the names of `library_calls` there are `V`, `W` and `X`, `Y`, the bodies' velocities and spins, and `DURATION`;
`moved` tells where a body is after a time, and how it is turned. The first body spins no faster than the second.
"""

from __future__ import annotations

from dataclasses import replace

from harness.compare.library_calls import CALLS, Call, ended_by
from harness.vocabulary import Shape

_FCL_MESH = """\
request, result = fcl.ContinuousCollisionRequest(
    num_max_iterations=100, toc_err=0.01, ccd_motion_type=fcl.CCDMotionType.CCDM_TRANS,
    ccd_solver_type=fcl.CCDSolverType.CCDC_NAIVE), fcl.ContinuousCollisionResult()
ends = [fcl.Transform(turn, place) for place, turn in (moved(P, Q, V, W, DURATION), moved(R, S, X, Y, DURATION))]
fcl.continuousCollide(body(A, FACES_A, P, Q), ends[0], body(B, FACES_B, R, S), ends[1], request, result)
return DURATION * result.time_of_contact if result.is_collide else None
"""
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
    # not of hulls: what FCL tells of those hangs on memory that it never set, and is another in the next process
    ("fcl", "mesh"): ended_by(CALLS["fcl", "mesh"], "return fcl.collide", _FCL_MESH),
    ("rapier3d", "hull"): replace(CALLS["rapier3d", "hull"], ask=_RAPIER.format(make="convex_hull(vertices.tolist())")),
    ("rapier3d", "mesh"): replace(
        CALLS["rapier3d", "mesh"], ask=_RAPIER.format(make="trimesh(vertices.tolist(), faces.tolist())")
    ),
}
"""Those that tell times of impact, by backend and shape. What they return is s, or None for never."""
