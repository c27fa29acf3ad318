"""The run as a gas of hard spheres, beside what kinetic theory says of one."""

from harness.measure.metric import Metric

METRICS = (
    Metric("collision_rate", "1/s", "physics", "pair hits of a body in a second", tabulated=False),
    Metric(
        "pressure", "Pa", "physics", "mean force on the walls over the area that centres can reach", tabulated=False
    ),
    Metric("virial_residual", "1", "error", "imbalance of the virial theorem over the run, relative", tabulated=False),
    Metric(
        "pressure_to_theory", "1", "physics", "pressure / that of kinetic theory for a box with walls", tabulated=False
    ),
    Metric(
        "pair_impulse_to_theory", "1", "physics", "mean impulse of a pair hit / that of kinetic theory",
        tabulated=False,
    ),
)  # fmt: skip
