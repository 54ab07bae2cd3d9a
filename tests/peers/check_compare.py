"""Checks compare.py itself on numbers whose truth is known. Exit code 1 if it is not as it must be.

Two sides are drawn from the same photon counts (Poisson, 16 runs each, a bright spot and a dim surrounding) many times: each of the
three p must fall below 0.05 in 5 % of the trials, within chance. Then one side is scaled by 1.01, and then one block of 64
is made 20 % brighter with the total kept: nearly all trials must find it.
"""

import sys

import numpy as np
from scipy import stats

import compare

TRIALS = 2000
RUNS = 16
SIZE = 64
BLOCK = 8


def photons_a_pixel():
    """The truth: about 2^19 photons a run, a spot in the middle."""
    row, column = np.mgrid[0:SIZE, 0:SIZE]
    return 60.0 + 2000.0 * np.exp(-((row - 30.0) ** 2 + (column - 34.0) ** 2) / 30.0)


def trials(generator, count, truth_ours, truth_theirs):
    """The three p of each of `count` comparisons."""
    result = []
    for _ in range(count):
        # Half the photons on one side: the two spreads differ, as they do in earnest.
        ours = compare.Estimate(generator.poisson(truth_ours, (RUNS, SIZE, SIZE)).astype(float), BLOCK)
        theirs = compare.Estimate(2.0 * generator.poisson(truth_theirs / 2, (RUNS, SIZE, SIZE)), BLOCK)
        verdict = compare.judge(ours, theirs, ours.bias)
        result.append([verdict["p_total"], verdict["p_blocks"], verdict["p_worst"]])
    return np.array(result)


def main():
    """Runs the checks."""
    generator = np.random.default_rng(1)
    truth = photons_a_pixel()
    good = True

    p = trials(generator, TRIALS, truth, truth)
    for name, below in zip(("total", "blocks", "worst block"), (p < 0.05).sum(axis=0)):
        chance = stats.binomtest(int(below), TRIALS, 0.05).pvalue
        good &= chance > 1e-3
        print(f"the same: p of {name} below 0.05 in {below / TRIALS:.2%} of {TRIALS} (5 %; chance {chance:.2g})")
    alarms = int((p.min(axis=1) < compare.LEVEL / 3).sum())
    good &= stats.binomtest(alarms, TRIALS, compare.LEVEL, alternative="greater").pvalue > 1e-3
    print(f"the same: {alarms} of {TRIALS} called different (at most about {compare.LEVEL * TRIALS:g})")

    block = truth.copy()
    block[8:16, 8:16] *= 1.2
    block *= truth.sum() / block.sum()
    for what, wrong in (("scaled by 1.01", truth * 1.01), ("one block 20 % brighter", block)):
        found = np.mean(trials(generator, 100, wrong, truth).min(axis=1) < compare.LEVEL / 3)
        good &= found > 0.95
        print(f"{what}: found in {found:.0%} of 100")
    print("as it must be" if good else "NOT as it must be")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
