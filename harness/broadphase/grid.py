"""The grid as a scheme: uniform, or hierarchical where bodies have different sizes."""

from harness.arrays import Floats
from harness.broadphase.hierarchical_grid import HierarchicalGrid
from harness.broadphase.scheme import Scheme
from harness.broadphase.uniform_grid import UniformGrid
from harness.scene.box import Box


def make(radii: Floats, box: Box, size_classes: bool) -> UniformGrid:
    """The grid for bodies of these radii (n,) in m: hierarchical if size classes are kept apart."""
    return (HierarchicalGrid if size_classes else UniformGrid)(radii, box)


SCHEME = Scheme("a grid of cells", make, "levels of cells, one for each factor of three or for several that are sparse")
