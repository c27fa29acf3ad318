"""The errors of a run against its reference, and of the reference itself."""

from harness.measure.metric import Better, Kind, Metric


def _hidden(name: str, unit: str, description: str, kind: Kind = "error", better: Better | None = None) -> Metric:
    return Metric(name, unit, kind, description, better=better, tabulated=False)


METRICS = (
    Metric(
        "missed_hits", "1", "error", "hits of the reference that were not reported, of the reference's hits", exact=True
    ),
    Metric(
        "extra_hits", "1", "error", "hits reported that the reference does not have, of the reference's hits",
        exact=True,
    ),
    Metric(
        "late_hits", "1", "error",
        "matched hits reported later than the truth by more than tolerance of a size at the closing speed, of query "
        "impact, of all matched ones", exact=True,
    ),
    Metric(
        "missed_pairs", "1", "error", "near pairs of the reference that were not reported, of the reference's pairs",
        exact=True,
    ),
    Metric(
        "extra_pairs", "1", "error", "near pairs reported that the reference does not have, of the reference's pairs",
        exact=True,
    ),
    Metric("gap_error", "m", "error", "median absolute error of the gaps of matched pairs"),
    _hidden("gap_error_95", "m", "95th percentile of the absolute errors of the gaps of matched pairs"),
    _hidden("gap_error_most", "m", "largest absolute error of the gap of a matched pair"),
    _hidden("witness_error", "m", "most that nearest points are off the bodies, or farther apart than the gap"),
    _hidden("reference_pairs", "1", "near pairs of the reference, in the frames that it looked at", "physics"),
    _hidden("reference_gap_error", "m", "how far the bounds on a gap of the reference are apart, at the most"),
    Metric("time_error", "s", "error", "median absolute time error of matched hits"),
    _hidden("time_error_95", "s", "95th percentile of the absolute time errors of matched hits"),
    Metric("position_error", "m", "error", "largest distance from the reference before the first divergence"),
    _hidden("divergence_time", "s", "first hit that the reference does not share; the duration without one",
            better="more"),
    _hidden("reference_divergence_time", "s", "first hit that the reference does not share with itself in other units",
            better="more"),
    _hidden("reference_position_error", "m", "largest distance of the reference from itself in other units, as long"),
    _hidden("reference_hits", "1", "hits of the reference while the method watched", "physics"),
    _hidden("reference_error", "s", "largest error found in a checked sample of the reference's hit times"),
    _hidden("missed_hits_expected", "1", "mean over the reference's hits of max(0, 1 - length of contact / dt)",
            "physics"),
    _hidden("missed_hits_deviation", "1", "missed hits beyond the expected ones, in standard deviations", "physics"),
)  # fmt: skip
