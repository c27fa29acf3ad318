"""No clock of a run may see a kernel being compiled."""

import gc
import pickle

import pytest
from numba.core.registry import CPUDispatcher

from harness.runner.execute import execute
from harness.runner.warm_up import warm_up, warm_ups
from harness.scene.mesh_file import make_mesh
from harness.scene.scene_files import SceneFiles
from tests.conftest import cube_mesh
from tests.runner.conftest import SPHERES


def compiled():
    """How many signatures each kernel of the package has been compiled for."""
    gc.unfreeze()  # else what was there when the tests had been collected would not be among the objects
    # of a million objects: `isinstance` takes a second to ask them all
    kernels = [found for found in gc.get_objects() if type(found) is CPUDispatcher]
    found = {
        f"{kernel.py_func.__module__}.{kernel.py_func.__name__}": len(kernel.signatures)
        for kernel in kernels
        if kernel.py_func.__module__.startswith("harness.")
    }
    assert found, "no kernel was found"
    return found


@pytest.mark.slow
@pytest.mark.parametrize("response", ["reflect", "elastic", "none"])
@pytest.mark.parametrize("record", [False, True])
def test_after_the_warm_up_no_event_loop_is_compiled(spheres, response, record):
    point = spheres(response=response, count=12, algorithm="predictive").points[0]
    warm_up(point)
    before = compiled()
    execute(point, SceneFiles(), traced=record)
    assert compiled() == before


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
@pytest.mark.parametrize("response", ["reflect", "elastic", "none"])
@pytest.mark.parametrize(
    ("count", "algorithm"), [(1, "brute-force"), (12, "brute-force"), (12, "grid"), (12, "predictive")]
)
def test_after_the_warm_up_nothing_is_compiled(spheres, shape, response, count, algorithm):
    cube = cube_mesh()
    mesh = pickle.loads(pickle.dumps(make_mesh("cube", cube.vertices, cube.faces)))  # as it reaches a server
    point = spheres(response=response, count=count, algorithm=algorithm).points[0]
    point = point.__class__(point.scene.model_copy(update={"shape": shape}), point.motion, point.engine)
    warm_up(point)
    before = compiled()
    execute(point, SceneFiles((mesh,)))
    assert compiled() == before


@pytest.mark.slow
@pytest.mark.parametrize("response", ["elastic", "none"])
def test_after_the_warm_up_nothing_is_compiled_for_a_reference(spheres, response):
    measured = SPHERES.replace("timeout: 20", "timeout: 20, reference: {}")
    point = spheres(measured, response=response, count=12, algorithm="grid").points[0]
    warm_up(point)
    before = compiled()
    execute(point, SceneFiles())
    assert compiled() == before


def test_a_run_waits_only_for_what_it_calls(spheres):
    def pieces(algorithm, shape, **forced):
        point = spheres(algorithm=algorithm, stages=forced).points[0]
        point = point.__class__(point.scene.model_copy(update={"shape": shape}), point.motion, point.engine)
        return {name for name, _ in warm_ups(point)}

    assert not warm_up(spheres().points[0]) or not warm_up(spheres().points[0])  # once a process
    few, more = pieces("brute-force", "sphere"), pieces("grid", "mesh")
    assert few < pieces("grid", "sphere")
    assert len(more - few) > len(few)
    assert pieces("tree", "mesh") < pieces("tree", "mesh", hull_axis=True)
