"""Estimates with their intervals, and paired comparisons. All intervals are at 95 %."""
import math
import warnings
from dataclasses import dataclass
from typing import Sequence

import numpy as np
from scipy import stats

_LEVEL = 0.95
_RESAMPLES = 2000
_LEAST_P = 1e-300


@dataclass(frozen=True)
class Estimate:
    """A value with its confidence interval."""

    value: float
    low: float
    high: float

    def text(self, digits: int = 2) -> str:
        """ "0.93 (0.91, 0.95)" """
        return f"{self.value:.{digits}f} ({self.low:.{digits}f}, {self.high:.{digits}f})"


def share(successes: int, trials: int) -> Estimate:
    """A proportion with Wilson's score interval. @throws ValueError  no trials"""
    if trials == 0:
        raise ValueError("a share of no trials")
    interval = stats.binomtest(successes, trials).proportion_ci(_LEVEL, method="wilson")
    return Estimate(successes / trials, interval.low, interval.high)


def mean(values: Sequence[float]) -> Estimate:
    """A mean with Student's interval; of a single value the interval is infinite. @throws ValueError  no values"""
    if len(values) == 0:
        raise ValueError("a mean of no values")
    centre = float(np.mean(values))
    if len(values) == 1:
        return Estimate(centre, -math.inf, math.inf)
    half = float(stats.sem(values)) * float(stats.t.ppf((1 + _LEVEL) / 2, len(values) - 1))
    return Estimate(centre, centre - half, centre + half)


@dataclass(frozen=True)
class Paired:
    """How two methods differ over the same trials: first against second."""

    pairs: int
    difference: Estimate  # of the means, first minus second
    ratio: Estimate  # of the means, first by second
    t_p: float  # two-sided, paired t-test; 1 when all pairs are equal
    wilcoxon_p: float  # two-sided, signed ranks


def paired(first: Sequence[float], second: Sequence[float]) -> Paired:
    """Compare trial by trial. The ratio's interval is a bootstrap over pairs with a fixed seed.

    @param first, second  shape [pairs], at least two; the means of `second` differ from 0
    @throws ValueError  different numbers of trials, or fewer than two
    """
    if len(first) != len(second):
        raise ValueError(f"found {len(first)} and {len(second)} trials, expected pairs")
    if len(first) < 2:
        raise ValueError("a comparison needs two pairs at least")
    a, b = np.asarray(first, float), np.asarray(second, float)
    draws = np.random.default_rng(1).integers(0, len(a), (_RESAMPLES, len(a)))
    ratios = a[draws].mean(axis=1) / b[draws].mean(axis=1)
    low, high = np.quantile(ratios, [(1 - _LEVEL) / 2, (1 + _LEVEL) / 2])
    equal = bool(np.all(a == b))
    constant = bool(np.ptp(a - b) == 0)
    return Paired(
        pairs=len(a),
        difference=mean(list(a - b)),
        ratio=Estimate(float(a.mean() / b.mean()), float(low), float(high)),
        t_p=1.0 if equal else 0.0 if constant else float(stats.ttest_rel(a, b).pvalue),
        wilcoxon_p=1.0 if equal else _wilcoxon_p(a, b),
    )


def _wilcoxon_p(a: np.ndarray, b: np.ndarray) -> float:
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore", UserWarning
        )  # about few pairs and ties: the report says how many pairs
        return float(stats.wilcoxon(a, b, zero_method="pratt").pvalue)


def p_text(p_value: float) -> str:
    """ "p = 0.0023"; what is too small to be represented is told so."""
    return f"p < {_LEAST_P:g}" if p_value < _LEAST_P else f"p = {p_value:.2g}"


def mcnemar_p(first: Sequence[bool], second: Sequence[bool]) -> float:
    """Exact two-sided test that two methods succeed equally often over the same trials."""
    only_first = sum(a and not b for a, b in zip(first, second))
    only_second = sum(b and not a for a, b in zip(first, second))
    if only_first + only_second == 0:
        return 1.0
    return float(stats.binomtest(only_first, only_first + only_second).pvalue)
