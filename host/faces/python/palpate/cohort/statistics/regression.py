# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""ln E of patients against a variable, weighted by how well each patient is known."""
from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import optimize, stats

from ..errors import CohortError


@dataclass
class Regression:
    """ln E = intercept + slope x + N(0, tau^2) + error of the patient.

    slope_interval   95 %, t with n - 2 degrees of freedom
    scatter          tau: sd of ln E between patients that neither the variable nor their own errors explain
    step_percent     what one step of the variable multiplies E by, less one, and its interval
    """

    intercept: float
    slope: float
    slope_se: float
    slope_interval: tuple[float, float]
    p: float
    scatter: float
    n: int

    @property
    def step_percent(self) -> tuple[float, float, float]:
        return tuple(100 * math.expm1(s) for s in (self.slope, *self.slope_interval))


def weighted(x, y, variance):
    """(coefficients [2], their covariance [2, 2], sum of squares) with weights 1 / variance, taken as known."""
    design = np.column_stack([np.ones(len(x)), x])
    weight = 1 / variance
    covariance = np.linalg.inv(design.T @ (weight[:, None] * design))
    coefficients = covariance @ (design.T @ (weight * y))
    return coefficients, covariance, float(weight @ (y - design @ coefficients) ** 2)


def weighted_regression(x, ln, sd) -> Regression:
    """x   value of each patient
    ln  of its stiffness
    sd  of that, the reference's error in it
    tau solves  sum (residual^2 / (sd^2 + tau^2)) = n - 2  (Paule and Mandel 1982, with a covariate: Berkey et al. 1995).
    Raises CohortError for less than three patients or a variable that is the same for all.
    """
    x, ln, sd = (np.asarray(v, float) for v in (x, ln, sd))
    n = len(x)
    if n < 3 or np.ptp(x) < 1e-12:
        raise CohortError("a regression needs three patients or more, and a variable that differs between them")

    def excess(tau2):
        return weighted(x, ln, sd**2 + tau2)[2] - (n - 2)

    tau2 = 0.0
    if excess(0.0) > 0:
        largest = float(np.var(ln)) * n + 1e-9
        while excess(largest) > 0:
            largest *= 4
        tau2 = optimize.brentq(excess, 0, largest, xtol=1e-14, rtol=1e-13)
    (intercept, slope), covariance, _ = weighted(x, ln, sd**2 + tau2)
    se = math.sqrt(covariance[1, 1])
    half = stats.t.ppf(0.975, n - 2) * se
    return Regression(float(intercept), float(slope), se, (float(slope - half), float(slope + half)),
                      float(2 * stats.t.sf(abs(slope) / se, n - 2)), math.sqrt(tau2), n)
