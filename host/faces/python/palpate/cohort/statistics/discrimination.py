# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""How well stiffness tells two classes of patients apart."""
from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

from .association import RESAMPLES, SEED, resampled


@dataclass
class Discrimination:
    """Area under the ROC curve: how often a patient of the higher class is the stiffer of two.

    p         Mann and Whitney, two-sided: exact where one class has at most 8 patients and no two values are equal, else the
              normal approximation with corrections for continuity and ties (method "auto" of SciPy)
    interval  95 %, bootstrap by patient
    classes   what is told apart, "T3 from below"
    """

    auc: float
    interval: tuple[float, float]
    p: float
    num_low: int
    num_high: int
    classes: str


def areas(is_high: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Of each row, ties counted half; nan without one of the classes. From the ranks: U = sum of ranks - n1 (n1 + 1) / 2."""
    ranks = stats.rankdata(y, axis=1)
    high = is_high.sum(axis=1)
    low = is_high.shape[1] - high
    with np.errstate(invalid="ignore", divide="ignore"):
        return ((ranks * is_high).sum(axis=1) - high * (high + 1) / 2) / (high * low)


def discrimination(is_high, y, classes: str = "", seed: int = SEED, resamples: int = RESAMPLES) -> Discrimination | None:
    """is_high, y  class and stiffness of each patient. None without patients of both classes."""
    is_high, y = np.asarray(is_high, bool), np.asarray(y, float)
    num_high = int(is_high.sum())
    num_low = len(y) - num_high
    if num_high == 0 or num_low == 0:
        return None
    auc = float(areas(is_high[None, :], y[None, :])[0])
    drawn = resampled(len(y), seed, resamples)
    values = areas(is_high[drawn], y[drawn])
    interval = (math.nan, math.nan) if len(y) < 3 else tuple(float(v) for v in np.nanpercentile(values, [2.5, 97.5]))
    p = float(stats.mannwhitneyu(y[is_high], y[~is_high], alternative="two-sided").pvalue)
    return Discrimination(auc, interval, p, num_low, num_high, classes)
