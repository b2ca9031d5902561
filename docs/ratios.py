# SPDX-License-Identifier: BSD-3-Clause
"""The ratio of a figure between two cells of a study, with its interval, as lidarena/results/stratified.cpp
computes it: paired runs, the worlds as strata."""
import collections
import math

LEVEL = 0.05
INFINITE = math.inf


def log_ratio(a, b):
    """log(b / a), infinite where one is that of a lost run; None for two lost runs."""
    if math.isinf(a) and math.isinf(b):
        return None
    if math.isinf(b):
        return b
    if math.isinf(a):
        return -a
    if a == b:
        return 0.0
    return -INFINITE if b == 0 else INFINITE if a == 0 else math.log(b) - math.log(a)


def distribution(weights):
    """Probability of each sum of the weights whose sign is positive, both signs equally likely."""
    p = {0: 1.0}
    for weight in weights:
        after = collections.defaultdict(float)
        for total, probability in p.items():
            after[total] += 0.5 * probability
            after[total + weight] += 0.5 * probability
        p = after
    return p


def critical_sum(strata, common):
    """The largest weighted rank sum whose probability, with all below it, is at most 2.5 %."""
    weights = [2 * rank * (common // (len(stratum) + 1))
               for stratum in strata for rank in range(1, len(stratum) + 1)]
    p = distribution(weights)
    below, critical = 0.0, None
    for total in sorted(p):
        below += p[total]
        if below > 0.5 * LEVEL:
            return critical
        critical = total
    return critical


def means_of(stratum):
    """The means of any two; of +infinity and -infinity one half on either side."""
    for i, a in enumerate(stratum):
        for b in stratum[i:]:
            mean = 0.5 * a + 0.5 * b
            yield from [(mean, 1.0)] if not math.isnan(mean) else [(INFINITE, 0.5), (-INFINITE, 0.5)]


def value_beyond(means, limit):
    total = 0.0
    for value, weight in means:
        total += weight
        if total > limit:
            return value
    return means[-1][0]


def ratio(strata):
    """The Hodges-Lehmann ratio b / a of log ratios by world, and its interval at 95 % or None."""
    strata = [stratum for stratum in strata if stratum]
    common = math.lcm(*(len(stratum) + 1 for stratum in strata))
    means = sorted((value, 2 * weight * (common // (len(stratum) + 1)))
                   for stratum in strata for value, weight in means_of(stratum))
    mirrored = [(-value, weight) for value, weight in reversed(means)]
    total = sum(weight for _, weight in means)
    tiny = 1e-9 * total
    low, high = value_beyond(means, total / 2 - tiny), -value_beyond(mirrored, total / 2 - tiny)
    middle = low if low == high else 0.5 * low + 0.5 * high
    found = 1.0 if math.isnan(middle) else math.exp(middle)
    critical = critical_sum(strata, common)
    if critical is None:
        return found, None
    return found, (math.exp(value_beyond(means, critical + tiny)),
                   math.exp(-value_beyond(mirrored, critical + tiny)))


def strata_of(pairs):
    """Log ratios by world of (world, a, b)."""
    worlds = collections.defaultdict(list)
    for world, a, b in pairs:
        found = log_ratio(a, b)
        if found is not None:
            worlds[world].append(found)
    return list(worlds.values())
