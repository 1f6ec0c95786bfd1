# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The error that all pairs of a patient share through their one reference.

Errors of pairs are  error(pair) = r(reference) + t(target) + e(pair),  independent normal numbers. The usual interval of a
patient's pairs takes r for something that more pairs average out. Its sd is estimated by restricted maximum likelihood
(Patterson and Thompson 1971), its interval by the profile of that likelihood.
"""
from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import linalg, optimize, stats

from ..errors import CohortError


@dataclass
class ReferenceError:
    """sd of ln E that a reference brings to all its pairs, with its 95 % interval.

    sd_target, sd_pair  the other two parts; sd_target is nan where only one reference a patient is known
    """

    sd: float
    low: float
    high: float
    sd_target: float
    sd_pair: float
    num_patients: int
    num_pairs: int
    source: str


@dataclass
class Block:
    """Pairs that share errors: y [n] ln, and which terms two pairs share, each [n, n] of 0 and 1."""

    y: np.ndarray
    shared: list


def same(labels) -> np.ndarray:
    labels = np.asarray(labels, dtype=object)
    return (labels[:, None] == labels[None, :]).astype(float)


def restricted_deviance(variances, blocks, mean_of_each: bool) -> float:
    """-2 ln of the restricted likelihood, but for a constant; variances of the terms, the pairs' own last.

    mean_of_each  every block has a mean of its own; otherwise all share one.
    """
    deviance, information, score, square = 0.0, 0.0, 0.0, 0.0
    for block in blocks:
        covariance = variances[-1] * np.eye(len(block.y))
        for variance, shared in zip(variances, block.shared):
            covariance += variance * shared
        factor = linalg.cho_factor(covariance, lower=True)
        solved = linalg.cho_solve(factor, np.column_stack([np.ones(len(block.y)), block.y]))
        deviance += 2 * np.log(np.diag(factor[0])).sum()
        a, b, c = solved[:, 0].sum(), block.y @ solved[:, 0], block.y @ solved[:, 1]
        if mean_of_each:
            deviance += math.log(a) + c - b * b / a
        else:
            information, score, square = information + a, score + b, square + c
    return deviance if mean_of_each else deviance + math.log(information) + square - score**2 / information


def fit(blocks, num_terms: int, mean_of_each: bool, reference_variance: float | None = None):
    """(least deviance, variances); the reference's variance, the first term, may be given."""
    y = np.concatenate([b.y - b.y.mean() if mean_of_each else b.y for b in blocks])
    scale = float(np.var(y)) or 1e-12
    given = [] if reference_variance is None else [reference_variance / scale]
    num_free = num_terms + 1 - len(given)

    def deviance(free):
        return restricted_deviance(scale * np.concatenate([given, free]), blocks, mean_of_each)

    best = None
    for share in (0.5, 0.1, 0.9):
        start = np.full(num_free, (1 - share) / max(1, num_free - 1))
        start[0] = share
        start[-1] = max(start[-1], 0.05)
        # The pairs' own variance stays above zero, where the likelihood has no value.
        found = optimize.minimize(deviance, start, method="L-BFGS-B", bounds=[(0, None)] * (num_free - 1) + [(1e-6, None)],
                                  options={"ftol": 1e-14, "gtol": 1e-9})
        if best is None or found.fun < best.fun:
            best = found
    return float(best.fun), scale * np.concatenate([given, best.x])


def profile_interval(blocks, num_terms: int, mean_of_each: bool, least: float, variance: float):
    """sd of the reference where the deviance is `chi2(0.95, 1)` above its least value."""
    allowed = stats.chi2.ppf(0.95, 1)

    def excess(sd):
        return fit(blocks, num_terms, mean_of_each, sd * sd)[0] - least - allowed

    sd = math.sqrt(variance)
    low = optimize.brentq(excess, 0, sd, xtol=1e-5) if sd > 1e-6 and excess(0.0) > 0 else 0.0
    high = max(2 * sd, 0.01)
    while excess(high) < 0 and high < 20:
        high *= 2
    return low, optimize.brentq(excess, sd, high, xtol=1e-5) if high < 20 else math.inf


def from_blocks(blocks, num_terms: int, mean_of_each: bool, source: str) -> ReferenceError:
    least, variances = fit(blocks, num_terms, mean_of_each)
    low, high = profile_interval(blocks, num_terms, mean_of_each, least, variances[0])
    sds = np.sqrt(variances)
    return ReferenceError(float(sds[0]), low, high, float(sds[1]) if num_terms > 1 else math.nan, float(sds[-1]),
                          len(blocks), sum(len(b.y) for b in blocks), source)


def reference_error_from_images(participant, reference, target, ln) -> ReferenceError:
    """From real patients of whom several images were the reference (`--also-reversed`).

    participant, reference, target  names of each pair; a target image has one name under all references. None: what targets
                                    share is not known, and counts as the pairs' own
    ln                              ln E of each pair
    Raises CohortError where no patient has two references of two pairs each.
    """
    participant, ln = np.asarray(participant, dtype=object), np.asarray(ln, float)
    reference = np.asarray(reference, dtype=object)
    target = None if target is None else np.asarray(target, dtype=object)
    blocks, num_useful = [], 0
    for one in dict.fromkeys(participant):
        of = participant == one
        if of.sum() < 3 or len(set(reference[of])) < 2:
            continue
        counts = [int((reference[of] == r).sum()) for r in set(reference[of])]
        num_useful += max(counts) > 1
        blocks.append(Block(ln[of], [same(reference[of])] + ([] if target is None else [same(target[of])])))
    if num_useful == 0:
        raise CohortError("the error of the reference shows only where a patient has several references, one of them with "
                          "several targets; add reversed pairs to the table (each target as reference)")
    return from_blocks(blocks, len(blocks[0].shared), True, f"pairs with several references of {len(blocks)} patients")


def reference_error_from_truth(participant, reference, ln_error) -> ReferenceError:
    """From phantoms: ln_error = ln E - ln of the true E of each pair. A bias common to all is taken out.

    Raises CohortError for less than three references.
    """
    reference = np.array([f"{p}\t{r}" for p, r in zip(participant, reference)], dtype=object)
    ln_error = np.asarray(ln_error, float)
    blocks = [Block(ln_error[reference == one], [same(reference[reference == one])]) for one in dict.fromkeys(reference)]
    if len(blocks) < 3 or max(len(b.y) for b in blocks) < 2:
        raise CohortError("the error of the reference needs three references or more, with several targets each")
    return from_blocks(blocks, 1, False, f"{len(blocks)} references of known stiffness")
