"""What the detection of hits was asked: frames, and tests of pairs and walls."""

from harness.measure.metric import Metric, counter

METRICS = (
    Metric("frames", "1", "count", "frames stepped: round(duration / dt)", better="neither", exact=True),
    counter("pair_tests", "pairs of bodies put to any test beyond bookkeeping", "object/object tests"),
    counter("near_pairs", "pairs whose gap is at most `within`, counted in every frame", kind="physics"),
    counter("narrow_tests", "pairs of bodies put to the exact shape", "object/object tests on the exact shape"),
    counter("hull_tests", "pairs of meshes whose hulls were put to a separating axis", tabulated=False),
    counter(
        "hull_searches", "pairs of hulls that the last frame's separating axis did not settle", tabulated=False
    ),
    counter("fcl_tests", "pairs put to FCL, where kernels settle the others", tabulated=False),
    counter(
        "contained_pairs", "pairs of which one mesh was wholly inside the other, which is no hit",
        kind="physics", tabulated=False,
    ),
    counter(
        "unfollowed_contacts", "contacts whose end could not be proved within a frame, taken to last through it",
        tabulated=False,
    ),
    counter("box_tests", "tests of a body against one of the six walls", "object/wall tests"),
    counter("pair_tests_per_body", "pair_tests / (frames · bodies), of a stepped run", tabulated=False),
    counter(
        "cells_per_body", "mean number of grid cells that a body's bounding cube overlaps, last frame", tabulated=False
    ),
    counter(
        "cells_per_body_most", "largest number of grid cells that a body's cube overlaps, last frame",
        title="largest number of cells of one body", tabulated=False,
    ),
)  # fmt: skip
