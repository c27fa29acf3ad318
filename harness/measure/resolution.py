"""What difference of a metric the repeats and the control of an experiment can resolve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from harness.measure.noise import FALSE_RATE, Control, distinguishable, p_value
from harness.measure.statistics import FEWEST_FOR_INTERVAL, summary

Distinction = Literal["apart", "same", "few", "uncontrolled"]
"""Told apart; not to be told apart; too few repeats to say; no control to say it by."""


@dataclass(frozen=True)
class Resolution:
    """Which ratios of a metric are told from 1.

    Parameters
    ----------
    control : of the metric; None where there is none
    level : the largest p-value that counts, see `harness.measure.noise.level`
    exact : whether the metric has no noise, so that any difference is one
    """

    control: Control | None = None
    level: float = FALSE_RATE
    exact: bool = False

    @property
    def floor(self) -> float | None:
        """The noise floor; None where it is not known."""
        return 0.0 if self.exact else None if self.control is None else self.control.floor

    def tell(self, ratios: ArrayLike) -> Distinction:
        """What the ratios of paired repeats say.

        >>> noise = Control((0.01, 0.01, 0.02, 0.02, 0.03))
        >>> Resolution(noise).tell([1.5, 1.6, 1.5, 1.4, 1.5]), Resolution(noise).tell([1.5, 1.6, 1.5])
        ('apart', 'few')
        """
        values = np.asarray(ratios, dtype=float)
        values = values[~np.isnan(values)]
        if self.exact:
            return "apart" if len(values) and distinguishable(summary(values), 0.0) else "same"
        if len(values) < FEWEST_FOR_INTERVAL:
            return "few"
        if self.control is None:
            return "uncontrolled"
        chance = self.p_value(values)
        if chance is None or chance > self.level:
            return "same"
        return "apart" if distinguishable(summary(values), self.control.floor) else "same"

    def p_value(self, ratios: ArrayLike) -> float | None:
        """The p-value of the ratios of paired repeats, None where nothing can be told of them."""
        values = np.asarray(ratios, dtype=float)
        values = values[np.isfinite(values) & (values > 0.0)]
        if self.exact or self.control is None or len(values) < FEWEST_FOR_INTERVAL:
            return None
        return p_value(values, self.control)
