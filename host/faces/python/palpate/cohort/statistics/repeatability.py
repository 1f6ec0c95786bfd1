# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""How much ln E differs between patients, and between scans of one patient.

ln E of the pairs, each with its prior: what a prior of sd s takes off a difference is the share (sd_ln / s)^2 of it, 0.7 % for
sd_ln 0.1 and s 1.2, but 6 % for 0.3. Scans of which many are weak differ by a little more than this says.
"""
from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np
from scipy import stats

from ..errors import CohortError


@dataclass
class Repeatability:
    """Of the mixed model ln_e ~ 1 + (1 | participant), by restricted maximum likelihood.

    between_sd, within_sd  tau and sigma, of ln E; intervals of 95 %
    icc                    tau^2 / (tau^2 + sigma^2)
    less_percent, more_percent   of two scans of one patient 95 % differ by less: exp(-+ 2.77 sigma) - 1
    """

    mean_ln: float
    between_sd: float
    within_sd: float
    within_interval: tuple[float, float]
    icc: float
    icc_interval: tuple[float, float]
    num_patients: int
    num_pairs: int

    @property
    def less_percent(self) -> float:
        return 100 * math.expm1(-2.77 * self.within_sd)

    @property
    def more_percent(self) -> float:
        return 100 * math.expm1(2.77 * self.within_sd)


def icc_interval(groups: list) -> tuple[float, float]:
    """95 % interval of the intraclass correlation from the ratio of mean squares, with the mean group size
    n0 = (N - sum n_i^2 / N) / (k - 1) where sizes differ (Donner 1979)."""
    sizes = np.array([len(g) for g in groups])
    k, total = len(groups), sizes.sum()
    n0 = (total - (sizes**2).sum() / total) / (k - 1)
    grand = np.concatenate(groups).mean()
    between = sum(len(g) * (g.mean() - grand) ** 2 for g in groups) / (k - 1)
    within = sum(((g - g.mean()) ** 2).sum() for g in groups) / (total - k)
    ratio = between / within
    upper = ratio / stats.f.ppf(0.025, k - 1, total - k)
    lower = ratio / stats.f.ppf(0.975, k - 1, total - k)
    return tuple(max(0.0, (f - 1) / (f - 1 + n0)) for f in (lower, upper))


def repeatability(participant, ln) -> Repeatability:
    """participant, ln  of each pair. Raises CohortError for less than two patients or no patient with two pairs."""
    from statsmodels.regression.mixed_linear_model import MixedLM

    participant, ln = np.asarray(participant, dtype=object), np.asarray(ln, float)
    groups = [ln[participant == one] for one in dict.fromkeys(participant)]
    freedom = len(ln) - len(groups)
    if len(groups) < 2 or freedom < 1:
        raise CohortError("what differs between scans needs two patients or more, and several pairs of one of them")
    squares = sum(((g - g.mean()) ** 2).sum() for g in groups)
    if squares <= 1e-20:
        raise CohortError("all pairs of a patient have the very same stiffness; nothing can be said of scans")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # on the boundary tau = 0, which is an answer
        found = MixedLM(ln, np.ones((len(ln), 1)), participant).fit(reml=True, method=["bfgs", "powell"])
    tau2, sigma2 = max(0.0, float(np.asarray(found.cov_re)[0, 0])), float(found.scale)
    sigma_interval = tuple(math.sqrt(squares / stats.chi2.ppf(p, freedom)) for p in (0.975, 0.025))
    return Repeatability(float(np.asarray(found.fe_params)[0]), math.sqrt(tau2), math.sqrt(sigma2), sigma_interval,
                         tau2 / (tau2 + sigma2), icc_interval(groups), len(groups), len(ln))
