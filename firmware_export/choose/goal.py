"""What an export shall meet, and how far a candidate is from it."""

import math
from dataclasses import dataclass

import numpy as np

from firmware_export.choose.trials import Candidate
from firmware_export.quantity import ErrorBound

# Percent: what is aimed at when nothing is asked for.
KNEE = ErrorBound(1.0, relative=True)
# Share of the stable configurations that an export should report unsafe at most.
MOST_FALSE_TIP = 0.05


@dataclass(frozen=True)
class Goal:
    """What is asked for.

    Parameters
    ----------
    flash : int, optional
        Most bytes, code included.
    percent : float, optional
        Greatest error in percent of the range.
    margin : float
        By which factor the chooser's own measurement must stay below it: the certificate looks
        at more points and searches for the worst.
    """

    flash: int | None
    percent: float | None
    margin: float = 1.3

    @property
    def aim(self) -> float:
        """The error to reach on the chooser's sample, percent; 0 for as small as can be."""
        return self.percent / self.margin if self.percent is not None else 0.0

    def holds(self, one: Candidate) -> bool:
        """Whether a candidate is accurate enough."""
        return one.false_safe == 0 and one.error <= (self.aim or math.inf)

    def fits(self, one: Candidate) -> bool:
        """Whether a candidate is small enough."""
        return one.false_safe == 0 and (self.flash is None or one.total <= self.flash)

    def serves(self, one: Candidate) -> bool:
        """Whether a candidate is accurate enough and reports little of what is stable unsafe."""
        return self.holds(one) and one.false_tip <= MOST_FALSE_TIP

    def score(self, one: Candidate) -> float:
        """Return how far a candidate is from the goal: 1 where it just meets it.

        A smooth maximum, so that a gain in what is not the worst counts a little.
        """
        aim = self.aim or KNEE.value / self.margin
        terms = [error / aim for error in one.errors.values()]
        terms.append(one.false_tip / MOST_FALSE_TIP)
        if not all(map(math.isfinite, terms)):
            return math.inf
        return float(np.sum(np.array(terms) ** 4) ** 0.25)
