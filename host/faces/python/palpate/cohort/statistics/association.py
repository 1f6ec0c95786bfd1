# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Stiffness against a clinical variable: one number a patient on both sides."""
from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

MOST_ARRANGEMENTS = 2_000_000
RANDOM_ARRANGEMENTS = 100_000
RESAMPLES = 10_000
SEED = 20111


@dataclass
class Correlation:
    """A coefficient with its test. n is the number of patients.

    interval    95 %, percentiles of the bootstrap by patient
    exact_p     by permutation of the variable's values over the patients; nan where it was not asked
    arrangements, is_exact, seed   what `exact_p` comes from: all of them, or as many random ones
    """

    test: str
    symbol: str
    value: float
    p: float
    n: int
    interval: tuple[float, float] = (math.nan, math.nan)
    exact_p: float = math.nan
    arrangements: int = 0
    is_exact: bool = True
    seed: int = SEED


def p_of_correlation(r: float, n: int) -> float:
    """Two-sided p of a correlation coefficient: t = r sqrt((n - 2) / (1 - r^2)) with n - 2 degrees of freedom."""
    if n < 3 or not math.isfinite(r):
        return math.nan
    if abs(r) >= 1:
        return 0.0
    return float(2 * stats.t.sf(abs(r) * math.sqrt((n - 2) / (1 - r * r)), n - 2))


def num_arrangements(values) -> int:
    """Distinct orders of values of which some are equal: n! / product of (count!)."""
    counts = np.unique(np.asarray(values), return_counts=True)[1]
    return math.factorial(int(counts.sum())) // math.prod(math.factorial(int(c)) for c in counts)


def all_arrangements(values) -> np.ndarray:
    """All distinct orders, [num_arrangements, n]: places for the first value, then for the next in what is left."""
    values = np.asarray(values, float)
    kinds, counts = np.unique(values, return_counts=True)
    orders = np.full((1, len(values)), np.nan)
    free = np.arange(len(values))[None, :]
    for kind, count in zip(kinds, counts):
        left = free.shape[1]
        chosen = np.array(list(itertools.combinations(range(left), int(count))), dtype=np.int64).reshape(-1, int(count))
        rest = np.array([np.setdiff1d(np.arange(left), c, assume_unique=True) for c in chosen], dtype=np.int64)
        repeated = np.repeat(np.arange(len(orders)), len(chosen))
        places = free[:, chosen].reshape(len(repeated), int(count))
        orders = orders[repeated]
        np.put_along_axis(orders, places, kind, axis=1)
        free = free[:, rest.reshape(len(chosen), left - int(count))].reshape(len(repeated), left - int(count))
    return orders


def permutation_p(x, y, seed: int = SEED) -> tuple[float, int, bool]:
    """Two-sided p of the correlation of x and y: the share of orders of x whose |correlation| is as large or larger.

    Exact over all distinct orders up to 2 million of them; beyond, 100,000 random ones, the observed one counted.
    Returns p, the number of orders, and whether they are all.
    """
    x, y = np.asarray(x, float), np.asarray(y, float)
    y = y - y.mean()
    observed = abs((x - x.mean()) @ y)
    limit = observed - 1e-9 * np.linalg.norm(x - x.mean()) * np.linalg.norm(y)
    if num_arrangements(x) <= MOST_ARRANGEMENTS:
        orders = all_arrangements(x)
        return float(np.mean(np.abs(orders @ y) >= limit)), len(orders), True
    random = np.random.default_rng(seed)
    as_large = 0
    for start in range(0, RANDOM_ARRANGEMENTS, 10_000):
        size = min(10_000, RANDOM_ARRANGEMENTS - start)
        orders = random.permuted(np.tile(x, (size, 1)), axis=1)
        as_large += int((np.abs(orders @ y) >= limit).sum())
    return (as_large + 1) / (RANDOM_ARRANGEMENTS + 1), RANDOM_ARRANGEMENTS, False


def row_correlations(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Pearson's r of each row, [resamples]; nan where a side is constant."""
    x, y = x - x.mean(axis=1, keepdims=True), y - y.mean(axis=1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        r = (x * y).sum(axis=1) / np.sqrt((x * x).sum(axis=1) * (y * y).sum(axis=1))
    constant = (np.ptp(x, axis=1) < 1e-12) | (np.ptp(y, axis=1) < 1e-12)
    return np.where(constant, np.nan, r)


def row_rank_correlations(x, y):
    return row_correlations(stats.rankdata(x, axis=1), stats.rankdata(y, axis=1))


def row_taus(x, y):
    """Kendall's tau-b of each row."""
    i, j = np.triu_indices(x.shape[1], 1)
    by_x, by_y = np.sign(x[:, i] - x[:, j]), np.sign(y[:, i] - y[:, j])
    with np.errstate(invalid="ignore", divide="ignore"):
        return (by_x * by_y).sum(axis=1) / np.sqrt((by_x**2).sum(axis=1) * (by_y**2).sum(axis=1))


def resampled(n: int, seed: int = SEED, resamples: int = RESAMPLES) -> np.ndarray:
    """Patients drawn with replacement, [resamples, n]."""
    return np.random.default_rng(seed).integers(0, n, (resamples, n))


def bootstrap_interval(x, y, statistic=row_correlations, seed: int = SEED, resamples: int = RESAMPLES):
    """95 % interval by percentiles over patients drawn with replacement; samples where a side is constant have no value."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    if len(x) < 3:
        return math.nan, math.nan
    drawn = resampled(len(x), seed, resamples)
    values = statistic(x[drawn], y[drawn])
    low, high = np.nanpercentile(values, [2.5, 97.5]) if np.isfinite(values).any() else (math.nan, math.nan)
    return float(low), float(high)


def is_constant(values) -> bool:
    return len(values) < 3 or np.ptp(np.asarray(values, float)) < 1e-12


def pearson(x, y, seed: int = SEED) -> Correlation:
    """Product-moment correlation, Student's t; x is the clinical variable, y the stiffness."""
    if is_constant(x) or is_constant(y):
        return Correlation("Pearson", "r", math.nan, math.nan, len(x))
    r, p = stats.pearsonr(x, y)
    exact, count, is_exact = permutation_p(x, y, seed)
    return Correlation("Pearson", "r", float(r), float(p), len(x), bootstrap_interval(x, y, seed=seed), exact, count,
                       is_exact, seed)


def spearman(x, y, seed: int = SEED) -> Correlation:
    """Rank correlation with mean ranks for ties: Student's t, and the exact permutation test."""
    if is_constant(x) or is_constant(y):
        return Correlation("Spearman", "ρ", math.nan, math.nan, len(x))
    rho, p = stats.spearmanr(x, y)
    exact, count, is_exact = permutation_p(stats.rankdata(x), stats.rankdata(y), seed)
    return Correlation("Spearman", "ρ", float(rho), float(p), len(x),
                       bootstrap_interval(x, y, row_rank_correlations, seed), exact, count, is_exact, seed)


def kendall(x, y, seed: int = SEED) -> Correlation:
    """Kendall's tau-b, the test of a trend over ordered classes; p as SciPy's `kendalltau` gives it (normal with ties)."""
    if is_constant(x) or is_constant(y):
        return Correlation("Kendall", "τ-b", math.nan, math.nan, len(x))
    tau, p = stats.kendalltau(x, y, variant="b")
    return Correlation("Kendall", "τ-b", float(tau), float(p), len(x), bootstrap_interval(x, y, row_taus, seed), seed=seed)
