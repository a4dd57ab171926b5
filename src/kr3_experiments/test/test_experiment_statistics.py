"""Intervals and tests against known values."""
import math

import pytest

from kr3_experiments.experiment.statistics import mcnemar_p, mean, p_text, paired, share


def test_wilson_interval_of_a_textbook_example() -> None:
    # Wilson's score interval for 15 of 20: centre and half width by its formula.
    z2 = 1.959963984540054**2
    centre = (0.75 + z2 / 40) / (1 + z2 / 20)
    half = math.sqrt(z2) * math.sqrt(0.75 * 0.25 / 20 + z2 / 1600) / (1 + z2 / 20)
    found = share(15, 20)
    assert (found.low, found.high) == pytest.approx((centre - half, centre + half))


def test_a_share_of_all_is_not_certain() -> None:
    found = share(50, 50)
    assert found.value == 1.0 and found.high == 1.0 and 0.9 < found.low < 0.95
    with pytest.raises(ValueError):
        share(0, 0)


def test_mean_with_students_interval() -> None:
    # t quantile for 4 degrees of freedom is 2.776; the standard error of 1..5 is sqrt(2.5 / 5).
    found = mean([1, 2, 3, 4, 5])
    assert found.value == 3
    assert found.high - 3 == pytest.approx(2.776445 * math.sqrt(0.5), rel=1e-6)
    assert mean([4.0]).low == -math.inf


def test_pairs_tell_what_means_hide() -> None:
    slow = [10.0, 100.0, 1000.0, 55.0, 7.0, 320.0]
    fast = [0.9 * value for value in slow]
    result = paired(fast, slow)
    assert result.ratio.value == pytest.approx(0.9)
    assert result.ratio.low == pytest.approx(0.9) and result.ratio.high == pytest.approx(0.9)
    assert result.wilcoxon_p == pytest.approx(2 / 2**6)  # all six signs agree
    assert result.difference.value < 0


def test_equal_methods_do_not_differ() -> None:
    result = paired([1.0, 2.0, 3.0], [1.0, 2.0, 3.0])
    assert (result.t_p, result.wilcoxon_p) == (1.0, 1.0)


def test_unequal_numbers_are_no_pairs() -> None:
    with pytest.raises(ValueError, match="expected pairs"):
        paired([1.0, 2.0], [1.0])
    with pytest.raises(ValueError, match="two pairs"):
        paired([1.0], [1.0])


def test_mcnemar_counts_disagreements_only() -> None:
    agree = [True] * 100
    assert mcnemar_p(agree + [True] * 6, agree + [False] * 6) == pytest.approx(2 / 2**6)
    assert mcnemar_p(agree, agree) == 1.0


def test_a_p_value_is_never_told_to_be_nothing() -> None:
    assert p_text(0.00234) == "p = 0.0023"
    assert p_text(0.0) == "p < 1e-300"
