"""Flights of scenes by method, for tests."""

from harness.methods.registry import method_of
from harness.motion.law import MotionLaw
from harness.vocabulary import OWN_BACKEND, MethodName, algorithms_of


def method_for(scene, algorithm, backend=OWN_BACKEND, tolerance=1e-6, forced=None):
    return method_of(MethodName(backend, algorithm, scene.shape), tolerance=tolerance, forced=forced)


def detector(scene, algorithm="grid", backend=OWN_BACKEND):
    """What finds the touching pairs of a scene, loaded with it."""
    method = method_for(scene, algorithm, backend)
    return method.detector(scene, method.detection(scene))


def planned(scene, algorithm, law, backend=OWN_BACKEND, forced=None, recorded=False):
    return method_for(scene, algorithm, backend, forced=forced).plan(scene, law, recorded=recorded)


def fly(scene, algorithm, law, *, backend=OWN_BACKEND, forced=None, recorded=False, traced=True):
    """Plan, load and fly, as a run does."""
    method = method_for(scene, algorithm, backend, forced=forced)
    return method.load(scene, method.plan(scene, law, recorded=recorded)).fly(law, traced=traced)


def frames_of(frames, dt, response="reflect", restitution=1.0):
    """The law of so many frames of dt (s)."""
    return MotionLaw(frames * dt, dt, response, restitution)


def default_algorithm(backend):
    return algorithms_of(backend)[0]
