"""What a run took: CPU time of its phases, with elapsed time beside it, and the rates that follow."""

from harness.measure.metric import clock

METRICS = (
    *clock("pair_seconds", "finding the touching pairs, pose updates included", "object/object test time"),
    *clock("box_seconds", "testing the box walls", "object/wall test time"),
    *clock("response_seconds", "answering hits", "response time"),
    *clock(
        "run_seconds",
        "the whole motion loop, without imports, compilation, placement, mesh building and recording",
        "run time",
        elapsed_tabulated=True,
    ),
    *clock("setup_seconds", "before the motion loop: placement, mesh building, loading the backend", "set-up time"),
    *clock("pair_seconds_per_frame", "pair_seconds / frames", "object/object test time a frame", tabulated=False),
    *clock("box_seconds_per_frame", "box_seconds / frames", "object/wall test time a frame", tabulated=False),
    *clock("frames_per_second", "frames / run_seconds", "frames per second", "1/s", "more", tabulated=False),
    *clock("simulated_per_second", "simulated seconds / run_seconds", "simulated seconds per second", "s/s", "more"),
)
