"""What comparisons of backends have found, in sentences."""

from __future__ import annotations

from markupsafe import Markup

from harness.report.backends.comparisons import Comparisons
from harness.report.quantity import number, plural


def summary(compared: Comparisons) -> list[Markup]:
    """What was found, in sentences."""
    verdicts = sum(tally["verdicts"] for tally in compared.pairs)
    real = sum(tally["real"] for tally in compared.pairs)
    undecided = sum(tally["undecided"] for tally in compared.pairs)
    checked = [row for record in compared.records for row in record.document["checked"]]
    judged, contradicted = sum(row["verdicts"] for row in checked), sum(row["contradicted"] for row in checked)
    crashed = sum(case["certificate"]["kind"] == "crashed" for case in compared.cases)
    found = [
        Markup(
            "{} of two backends on the same poses: <strong>{}</strong> really disagree, {} lie inside a band."
        ).format(plural(verdicts, "verdict"), number(real) if real else "none", number(undecided))
    ]
    blamed: dict[str, int] = {}
    for case in compared.cases:
        if case["certificate"]["kind"] != "crashed":
            blamed[case["wrong"]] = blamed.get(case["wrong"], 0) + 1
    for name, count in sorted(blamed.items()):
        found.append(Markup("<strong>{}</strong> was proven wrong {}.").format(name, plural(count, "time")))
    if crashed:
        found.append(Markup("A backend crashed or hung at {}.").format(plural(crashed, "pose")))
    both = f"{number(contradicted)} of them are wrong, both backends alike" if contradicted else "all of them are right"
    if judged:
        found.append(
            Markup("Of the verdicts that two agree on, {} were judged as well: {}.").format(number(judged), both)
        )
    return found
