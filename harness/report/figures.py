"""Which figures an experiment has: every metric it asks for against its x, and the published numbers beside ours.

A figure says in words what it shows, for those who cannot see it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from markupsafe import Markup, escape

from harness.report import palette
from harness.report.drawing import Form, Line, Panel, Slope, draw_exponents, draw_panels
from harness.report.published import Row, metrics_of
from harness.report.quantity import Scale, leaf_text, number, scale
from harness.report.series import Arrangement, Series
from harness.report.words import is_noisy, leaf_title, metric_title, metric_unit

# Below these ranges a logarithmic axis has no two round numbers on it.
_LOG_X, _LOG_Y = 4.0, 2.5
_MOST_PANELS = 8


@dataclass(frozen=True)
class Key:
    """One entry of a legend."""

    label: str
    style: int
    foreign: bool = False


@dataclass(frozen=True, eq=False)
class Figure:
    """One figure in all its forms; `name` is unique on its page and names its file."""

    name: str
    title: str
    description: str
    caption: str
    draw: Callable[[Form, str], str]
    keys: tuple[Key, ...] = ()
    labelled: bool = True
    file: str = ""

    def svg(self, form: Form) -> Markup:
        """The drawing for a page: its colours follow the page's."""
        return Markup(palette.themed(self._described(form)))

    @cached_property
    def document(self) -> str:
        """The wide drawing as a file of its own, in light colours on white."""
        text = palette.fixed(self._described("wide"))
        box = text.split('viewBox="', 1)[1].split('"', 1)[0]
        _, _, width, height = box.split()
        head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" '
        ground = f'<rect width="{width}" height="{height}" fill="#ffffff"/>'
        text = text.replace("<svg ", head, 1)
        return text.replace("</desc>", f"</desc>{ground}", 1) + "\n"

    def _described(self, form: Form) -> str:
        if form not in self._drawn:
            self._drawn[form] = self.draw(form, f"{self.name}-{form}")
        name = f"{self.name}-{form}"
        spoken = (
            f'<svg role="img" aria-labelledby="{name}-t" aria-describedby="{name}-d" \\g'
            f'<title id="{name}-t">{escape(self.title)}</title><desc id="{name}-d">{escape(self.description)}</desc>'
        )
        head, tail = self._drawn[form].split(">", 1)
        return spoken.replace("\\g", f"{head.removeprefix('<svg ')}>", 1) + tail

    @cached_property
    def _drawn(self) -> dict[Form, str]:
        return {}


def metric_figures(arrangement: Arrangement) -> list[Figure]:
    """A figure a metric; one for all metrics of a unit where there is only one series to tell apart."""
    if arrangement.x is None or len(arrangement.x_values) < 2:
        return []
    metrics = [metric for metric in arrangement.metrics if _measured(arrangement, metric)]
    if len(arrangement.series) > 1:
        return [_figure(arrangement, (metric,)) for metric in metrics]
    units = dict.fromkeys(map(metric_unit, metrics))
    return [_figure(arrangement, tuple(m for m in metrics if metric_unit(m) == unit)) for unit in units]


def exponent_figure(exponents: Sequence[Slope], leaf: str, metric: str = "") -> Figure:
    """Fitted exponents with their intervals; `metric` is named where all are of one."""
    of = f" of {metric_title(metric)}" if metric else ""
    said = "; ".join(f"{row.label} {row.value:.2f}, {row.low:.2f} to {row.high:.2f}" for row in exponents)
    return Figure(
        "exponents",
        f"Growth exponents{of} over {leaf}",
        f"Exponents with their intervals: {said}.",
        f"Exponents{of}: slopes on logarithmic axes, with their intervals. Dotted: the whole numbers.",
        lambda form, name: draw_exponents(exponents, leaf, form, name),
    )


def published_figure(rows: Sequence[Row], source: str) -> Figure | None:
    """The published numbers and ours, a panel a metric, over the leaf that tells the rows apart."""
    leaves = [leaf for leaf in rows[0].leaves if all(isinstance(row.leaves.get(leaf), int | float) for row in rows)]
    if not leaves or len({row.leaves[leaves[0]] for row in rows}) < 2:
        return None
    leaf, panels = leaves[0], []
    series = {row.series: row.style for row in rows if row.point}
    for metric in metrics_of(rows):
        theirs = {float(row.leaves[leaf]): row.numbers[metric] for row in rows if metric in row.numbers}
        ours = {
            name: {float(row.leaves[leaf]): row.ours(metric) for row in rows if row.series == name and row.point}
            for name in series
        }
        unit = scale(
            [*theirs.values(), *(value for line in ours.values() for value in line.values())], metric_unit(metric)
        )
        lines = [_plain(name, series[name], values, unit) for name, values in ours.items()]
        lines.append(replace(_plain("published", 0, theirs, unit), foreign=True))
        panel = Panel(metric_title(metric), f"{leaf_title(leaf)} ({leaf})", _axis_title(metric, unit), tuple(lines))
        panels.append(_with_scale(replace(panel, x_text=leaf_text)))
    said = f"Each panel compares the published numbers of {source} (dashed) with ours, over {leaf_title(leaf)}."
    keys = (*(Key(name, style) for name, style in series.items()), Key("published", 0, foreign=True))
    return Figure(
        "published",
        "Published numbers and ours",
        " ".join([said, *(_spoken(panel) for panel in panels)]),
        "Hollow markers and dashed lines: published. Filled: measured here, medians.",
        lambda form, name: draw_panels(panels, form, name, labels=False),
        keys,
        labelled=False,
    )


def _figure(arrangement: Arrangement, metrics: tuple[str, ...]) -> Figure:
    unit = scale([point.median(metric) for point in arrangement.points for metric in metrics], metric_unit(metrics[0]))
    names = arrangement.panels[:_MOST_PANELS]
    by_metric = len(metrics) > 1
    panels = []
    for name in names:
        inside = [series for series in arrangement.series if series.panel == name]
        lines = (
            [replace(_line(inside[0], metric, unit, arrangement), label=metric, style=place)
             for place, metric in enumerate(metrics)]
            if by_metric
            else [_line(series, metrics[0], unit, arrangement) for series in inside]
        )  # fmt: skip
        panels.append(_panel(arrangement, name, metrics, lines, unit))
    logarithmic = all(_ranges(panel) for panel in panels) and not panels[0].categories
    panels = [replace(panel, logarithmic=logarithmic) for panel in panels]
    title = _capital(" and ".join(map(metric_title, metrics)))
    assert arrangement.x is not None
    over = leaf_title(arrangement.x)
    kind = "Log-log plot" if logarithmic else "Plot"
    keys = {line.label: Key(line.label, line.style) for panel in panels for line in panel.lines}
    left = len(arrangement.panels) - len(names)
    return Figure(
        "-".join(metrics),
        f"{title} against {over}",
        f"{kind} of {title.lower()} against {over}. {' '.join(map(_spoken, panels))}",
        _caption(arrangement, metrics, logarithmic) + (f" {left} more panels are in the table only." if left else ""),
        lambda form, name: draw_panels(panels if form != "card" else panels[:1], form, name),
        tuple(keys.values()),
        labelled=True,
    )


def _panel(arrangement: Arrangement, name: str, metrics: Sequence[str], lines: Sequence[Line], unit: Scale) -> Panel:
    assert arrangement.x is not None
    categories = () if arrangement.numeric else tuple(map(leaf_text, arrangement.x_values))
    label = _axis_title(metrics[0], unit) if len(metrics) == 1 else unit.symbol
    over = leaf_title(arrangement.x)
    x_label = over if over == arrangement.x else f"{over} ({arrangement.x})"
    return Panel(name, x_label, label, tuple(lines), categories, x_text=leaf_text)


def _line(series: Series, metric: str, unit: Scale, arrangement: Arrangement) -> Line:
    x, y, low, high = [], [], [], []
    for point, value in zip(series.points, series.x, strict=True):
        found = point.summary(metric)
        if found is None:
            continue
        x.append(float(value) if arrangement.numeric else float(arrangement.x_values.index(value)))
        y.append(found.median / unit.factor)
        low.append(found.low / unit.factor)
        high.append(found.high / unit.factor)
    return Line(series.label, series.style, tuple(x), tuple(y), tuple(low), tuple(high))


def _plain(label: str, style: int, values: dict[float, float], unit: Scale) -> Line:
    seen = {x: y for x, y in sorted(values.items()) if math.isfinite(y)}
    return Line(label, style, tuple(seen), tuple(value / unit.factor for value in seen.values()))


def _with_scale(panel: Panel) -> Panel:
    return replace(panel, logarithmic=_ranges(panel))


def _ranges(panel: Panel) -> bool:
    """Whether both axes are positive and span enough for logarithms."""
    xs = [x for line in panel.lines for x in line.x]
    ys = [y for line in panel.lines for y in (*line.y, *line.low)]
    if not xs or min(xs) <= 0 or min(ys) <= 0:
        return False
    return max(xs) / min(xs) >= _LOG_X and max(ys) / min(ys) >= _LOG_Y


def _measured(arrangement: Arrangement, metric: str) -> bool:
    return any(point.summary(metric) for point in arrangement.points)


def _axis_title(metric: str, unit: Scale) -> str:
    return f"{metric}, {unit.symbol}" if unit.symbol else metric


def _caption(arrangement: Arrangement, metrics: Sequence[str], logarithmic: bool) -> str:
    said = []
    shape = "band" if arrangement.numeric else "bar"
    if any(map(is_noisy, metrics)):
        found = [point.summary(metric) for point in arrangement.points for metric in metrics]
        counts = [summary.n for summary in found if summary]
        if max(counts) == 1:
            said.append("One run a point: no interval.")
        elif all(summary.coverage is None for summary in found if summary):
            said.append(f"Medians; the {shape} is the range of the repeats, too few for an interval.")
        else:
            said.append(f"Medians; the {shape} is the median's interval.")
    else:
        said.append("Exact: the same in every repeat.")
    if logarithmic:
        said.append("Both axes are logarithmic: a straight line is a power law, and its slope the exponent.")
    elif not arrangement.numeric:
        said.append("The dotted line only guides the eye.")
    return " ".join(said)


def _spoken(panel: Panel) -> str:
    said = []
    for line in panel.lines:
        if line.y:
            ends = [
                (panel.categories[int(x)] if panel.categories else panel.x_text(x)) for x in (line.x[0], line.x[-1])
            ]
            unit = panel.y_label.rpartition(", ")[2] if ", " in panel.y_label else ""
            said.append(
                f"{line.label}: {number(line.y[0])} {unit} at {ends[0]}, {number(line.y[-1])} {unit} at {ends[1]}."
            )
    return " ".join([f"{panel.title}:" if panel.title else "", *said]).replace("  ", " ").replace(" .", ".").strip()


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
