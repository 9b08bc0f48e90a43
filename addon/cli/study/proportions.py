# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics of one proportion against one half, by scipy, which `encre study --analyse` and `--plan` alone need."""

from dataclasses import dataclass

from ...pen.errors import EncreError

try:
    from scipy.optimize import brentq
    from scipy.stats import binom, binomtest, norm
except ImportError:
    raise EncreError("the statistics of a study need scipy; install it with `pip install scipy`") from None

ALPHA, POWER = 0.05, 0.8
_MOST = 100_000  # people
_STEADY = 200    # numbers of people in a row for which the exact test, whose power goes up and down, has it


@dataclass
class Found:
    share: float
    low: float   # of its 95 % interval, exact (Clopper and Pearson)
    high: float
    p: float     # two-tailed, exact


def test(chosen, count):
    """Of `count` people `chosen` prefer one of two."""
    result = binomtest(chosen, count, 0.5)
    between = result.proportion_ci(1 - ALPHA, method="exact")
    return Found(chosen / count, between.low, between.high, result.pvalue)


def power(share, count):
    """How likely a study of `count` people finds that this share, not half, prefers one look: the normal approximation
    of a two-tailed z-test."""
    far, spread = norm.ppf(1 - ALPHA / 2) * 0.5, (share * (1 - share)) ** 0.5
    apart = (share - 0.5) * count ** 0.5
    return norm.cdf((apart - far) / spread) + norm.cdf((-apart - far) / spread)


def threshold(count, wanted=POWER):
    """The share that so many people find with this power."""
    return brentq(lambda share: power(share, count) - wanted, 0.5 + 1e-9, 1 - 1e-9)


def people(share, wanted=POWER):
    """How many people find this share with this power. EncreError: more than can be asked."""
    if not 0.5 < share < 1 or not ALPHA < wanted < 1:
        raise EncreError("give a share above 0.5 and below 1, and a power above 0.05 and below 1")
    low, high = 1, 2
    while power(share, high) < wanted:
        low, high = high, 2 * high
        if high > _MOST:
            raise EncreError(f"{share:g} is so near to one half that more than {_MOST} people are needed; plan for a "
                             "share that is farther from it")
    while low + 1 < high:
        middle = (low + high) // 2
        low, high = (low, middle) if power(share, middle) >= wanted else (middle, high)
    return high


def power_exact(share, count):
    """Likewise of the exact test."""
    # The largest number that is few enough to be found; as many at the other end.
    few = int(binom.ppf(ALPHA / 2, count, 0.5))
    while few >= 0 and binomtest(few, count, 0.5).pvalue >= ALPHA:
        few -= 1
    return binom.cdf(few, count, share) + binom.sf(count - few - 1, count, share)


def people_exact(share, wanted=POWER):
    """The number from which on the exact test finds this share with this power."""
    last = people(share, wanted) + _STEADY
    count = last
    while count > 1 and power_exact(share, count - 1) >= wanted:
        count -= 1
    return count
