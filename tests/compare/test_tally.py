"""Counts add up, each in its own bin."""

from harness.compare.tally import GapHistogram, decade_of


def test_gaps_are_counted_by_their_decade():
    assert [decade_of(gap) for gap in (0.0, 5e-17, 2e-15, 1e-15, -3e-3, 0.5, -7.0)] == [0, 0, 2, 2, -14, 16, -16]
    axis, other = GapHistogram(("a", "b"), "hull"), GapHistogram(("a", "b"), "hull")
    axis.count("real", 1e-3)
    other.count("real", 2e-3)
    other.count("undecided", -1e-12)
    axis.add(other)
    assert axis.counts == {"real": {14: 2}, "undecided": {-5: 1}}
