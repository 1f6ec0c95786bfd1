# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The stiffness of one patient from all its pairs, three ways side by side."""
from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import stats
from statsmodels.stats.meta_analysis import combine_effects

LEVEL = 0.95


@dataclass
class LnEstimate:
    """A patient's ln E and its errors; E in kPa.

    se              standard error from the scatter or the widths of the pairs
    freedom         degrees of freedom of `se`; inf: normal
    sd_reference    what all pairs share through their one reference, which no number of pairs averages out
    between_pairs   sd of ln E between pairs beyond their own widths (tau); nan where it is not estimated
    """

    ln: float
    se: float
    freedom: float
    sd_reference: float
    num_pairs: int
    between_pairs: float = math.nan

    @property
    def kpa(self) -> float:
        return math.exp(self.ln)

    @property
    def sd(self) -> float:
        return math.hypot(self.se, self.sd_reference)

    def half_width(self, level: float = LEVEL) -> float:
        """Of ln E. The two errors are independent: their half widths, of t and of the normal law, add as squares."""
        tail = 0.5 + level / 2
        t = stats.t.ppf(tail, self.freedom) if math.isfinite(self.freedom) else stats.norm.ppf(tail)
        return math.hypot(t * self.se, stats.norm.ppf(tail) * self.sd_reference)

    def interval_kpa(self, level: float = LEVEL) -> tuple[float, float]:
        half = self.half_width(level)
        return math.exp(self.ln - half), math.exp(self.ln + half)


def arithmetic(kpa) -> tuple[float, float]:
    """Mean and standard deviation (n - 1) of the pairs, kPa: what publications print. sd is nan for one pair."""
    kpa = np.asarray(kpa, float)
    return float(kpa.mean()), float(kpa.std(ddof=1)) if len(kpa) > 1 else math.nan


def with_width(ln, sd) -> tuple[np.ndarray, np.ndarray]:
    """Without pairs whose data say nothing (no finite estimate or width)."""
    ln, sd = np.asarray(ln, float), np.asarray(sd, float)
    usable = np.isfinite(ln) & np.isfinite(sd) & (sd > 0)
    return ln[usable], sd[usable]


def random_effects(ln, sd, sd_reference: float = 0.0) -> LnEstimate | None:
    """Mean of ln E weighted by 1 / (sd^2 + tau^2), tau from the scatter (Paule and Mandel 1982), t with n - 1 degrees.

    ln, sd  of each pair, prior taken out. One pair: its own normal interval. None where no pair has a width.
    """
    ln, sd = with_width(ln, sd)
    if len(ln) == 0:
        return None
    if len(ln) == 1:
        return LnEstimate(float(ln[0]), float(sd[0]), math.inf, sd_reference, 1)
    found = combine_effects(ln, sd**2, method_re="iterated", use_t=True)
    return LnEstimate(float(found.mean_effect_re), float(found.sd_eff_w_re), len(ln) - 1, sd_reference, len(ln),
                      math.sqrt(max(0.0, float(found.tau2))))


def joint(ln, sd, sd_reference: float = 0.0) -> LnEstimate | None:
    """All pairs as one likelihood of one ln E, each normal with the prior taken out: weights 1 / sd^2, no tau."""
    ln, sd = with_width(ln, sd)
    if len(ln) == 0:
        return None
    weight = sd**-2.0
    return LnEstimate(float(weight @ ln / weight.sum()), float(weight.sum() ** -0.5), math.inf, sd_reference, len(ln))


def estimate_cells(prefix: str, estimate: LnEstimate | None) -> dict[str, float]:
    if estimate is None:
        return {f"{prefix}_{name}": math.nan for name in ("kpa", "low_kpa", "high_kpa", "ln", "se_ln")}
    low, high = estimate.interval_kpa()
    return {f"{prefix}_kpa": estimate.kpa, f"{prefix}_low_kpa": low, f"{prefix}_high_kpa": high,
            f"{prefix}_ln": estimate.ln, f"{prefix}_se_ln": estimate.se}


def patient_table(pairs: pd.DataFrame, sd_reference: float = 0.0) -> pd.DataFrame:
    """A row a patient, in the order of first appearance.

    pairs  participant_id, reference, verdict, e_kpa, ln_e_data, sd_data: rows that enter (`Pairs.used`). With several references
           of a patient the pairs' shared errors are averaged; each reference then counts as sd_reference / sqrt(references).
    """
    rows = []
    for participant, of_patient in pairs.groupby("participant_id", sort=False):
        references = of_patient["reference"].nunique()
        shared = sd_reference / math.sqrt(references)
        mean, sd = arithmetic(of_patient["e_kpa"])
        weighted = random_effects(of_patient["ln_e_data"], of_patient["sd_data"], shared)
        together = joint(of_patient["ln_e_data"], of_patient["sd_data"], shared)
        rows.append({"participant_id": participant, "pairs": len(of_patient), "references": references,
                     "weak": int((of_patient["verdict"] == "weak").sum()), "mean_kpa": mean, "sd_kpa": sd,
                     **estimate_cells("random_effects", weighted),
                     "between_pairs_ln": math.nan if weighted is None else weighted.between_pairs,
                     **estimate_cells("joint", together), "sd_reference": shared})
    return pd.DataFrame(rows).set_index("participant_id") if rows else pd.DataFrame()
