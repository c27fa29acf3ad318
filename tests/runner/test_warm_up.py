"""No clock of a run may see a kernel being compiled."""

import gc
import pickle

import pytest
from numba.core.dispatcher import Dispatcher

from harness.runner.execute import execute, warm_up
from harness.scene.mesh_file import make_mesh
from tests.conftest import cube_mesh


def compiled():
    """How many signatures each kernel of the package has been compiled for."""
    kernels = [found for found in gc.get_objects() if isinstance(found, Dispatcher)]
    return {
        f"{found.py_func.__module__}.{found.py_func.__name__}": len(found.signatures)
        for found in kernels
        if found.py_func.__module__.startswith("harness.")
    }


@pytest.mark.parametrize("response", ["reflect", "elastic", "none"])
@pytest.mark.parametrize("record", [False, True])
def test_after_the_warm_up_no_event_loop_is_compiled(spheres, response, record):
    warm_up()
    execute(spheres(response=response).points[0], None)
    before = compiled()
    point = spheres(response=response, count=12, algorithm="predictive").points[0]
    execute(point, None, traced=record)
    assert compiled() == before


@pytest.mark.parametrize("shape", ["sphere", "hull", "mesh"])
@pytest.mark.parametrize("response", ["reflect", "elastic", "none"])
@pytest.mark.parametrize(
    ("count", "algorithm"), [(1, "brute-force"), (12, "brute-force"), (12, "grid"), (12, "predictive")]
)
def test_after_the_warm_up_nothing_is_compiled(spheres, shape, response, count, algorithm):
    warm_up()
    cube = cube_mesh()
    mesh = pickle.loads(pickle.dumps(make_mesh("cube", cube.vertices, cube.faces)))  # as it reaches a server
    before = compiled()
    point = spheres(response=response, count=count, algorithm=algorithm).points[0]
    point = point.__class__(point.scene.model_copy(update={"shape": shape}), point.motion, point.engine)
    execute(point, mesh)
    assert compiled() == before
