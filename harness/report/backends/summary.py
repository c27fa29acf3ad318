"""What comparisons of backends have found, in sentences."""

from __future__ import annotations

from collections import Counter, defaultdict

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
    found = [
        Markup(
            "{} of two backends on the same poses: <strong>{}</strong> really disagree, {} lie inside a band."
        ).format(plural(verdicts, "verdict"), number(real) if real else "none", number(undecided))
    ]
    blamed, failed = Counter[str](), defaultdict[str, list[str]](list)
    for case in compared.cases:
        if case["certificate"]["kind"] == "crashed":
            failed[case["wrong"]].append(case["certificate"]["reason"])
        else:
            blamed[case["wrong"]] += 1
    for name, count in sorted(blamed.items()):
        found.append(Markup("<strong>{}</strong> was proven wrong {}.").format(name, plural(count, "time")))
    for name, reasons in compared.findings.items():
        more = f", and {plural(len(reasons) - 1, 'finding')} like it" if len(reasons) > 1 else ""
        found.append(Markup("<strong>{}</strong> is wrong: {}{}.").format(name, reasons[0], more))
    for name, reasons in sorted(failed.items()):
        found.append(
            Markup("<strong>{}</strong> failed at {}: {}.").format(name, plural(len(reasons), "pose"), reasons[0])
        )
    both = f"{number(contradicted)} of them are wrong, both backends alike" if contradicted else "all of them are right"
    if judged:
        found.append(
            Markup("Of the verdicts that two agree on, {} were judged as well: {}.").format(number(judged), both)
        )
    return found
