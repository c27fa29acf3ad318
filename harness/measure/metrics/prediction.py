"""What an event-driven run did beside its events: searches, and the upkeep of cells and neighbour lists."""

from harness.measure.metric import counter

METRICS = (
    counter("predictions", "searches for a body's next event"),
    counter(
        "stale_events", "predicted events whose partner had changed course, and so were predicted anew",
        tabulated=False,
    ),
    counter("cell_crossings", "passages of a body from cell to cell", tabulated=False),
    counter("list_renewals", "neighbour lists made anew", tabulated=False),
    counter(
        "guarded_hits", "inelastic hits answered elastically, as part of a lasting contact (TC model)", tabulated=False
    ),
    counter(
        "stalled_events", "times a body was made to wait, because too many events came in one burst", tabulated=False
    ),
    counter("advancement_steps", "steps of conservative advancement in all searches for a contact", tabulated=False),
    counter("predictions_per_event", "predictions / events", tabulated=False),
    counter("pair_tests_per_event", "pair_tests / events, of a predictive run", tabulated=False),
)  # fmt: skip
