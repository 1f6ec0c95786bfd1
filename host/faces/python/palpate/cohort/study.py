# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Everything that is said about a cohort, from its two tables: what `report` draws."""
from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from .errors import CohortError
from .statistics import (discrimination, kendall, patient_table, pearson, reference_error_from_images, repeatability, spearman,
                         to_variable, weighted_regression)
from .tables import Pairs, variable_of

FEWEST_PATIENTS = 3  # for a test


@dataclass
class Study:
    """patients      `patient_table`, a row a patient
    reference_source  where the sd of the shared error is from, in words
    variable      of `tested` patients, None without one
    correlations  (what is correlated, Correlation)
    notes         what could not be said, and why: sentences
    """

    pairs: Pairs
    patients: pd.DataFrame
    sd_reference: float
    reference_source: str
    scans: object = None
    variable: object = None
    tested: list = field(default_factory=list)
    correlations: list = field(default_factory=list)
    regression: object = None
    discriminations: list = field(default_factory=list)
    notes: list = field(default_factory=list)


def shared_error(pairs: Pairs, given: float | None) -> tuple[float, str]:
    """sd of ln E that all pairs of a reference share: given, else from patients with several references, else 0."""
    if given is not None:
        return given, "given"
    used = pairs.used
    try:
        # `target-01` is another image under each reference.
        found = reference_error_from_images(used["participant_id"], used["reference"], None, used["ln_e"])
    except CohortError:
        return 0.0, "not known and taken as 0: intervals of patients are too narrow"
    return found.sd, f"{found.source}, 95 % interval {found.low:.3f} to {found.high:.3f}"


def against(study: Study, texts: pd.Series, order) -> None:
    """Adds what is tested against a clinical variable; n is the number of patients with a stiffness and a value."""
    patients = study.patients
    usable = [p for p in patients.index if texts[p] and np.isfinite(patients.loc[p, "random_effects_ln"])]
    missing = len(patients) - len(usable)
    if missing:
        study.notes.append(f"{missing} of {len(patients)} patients have no value of '{texts.name}', or no stiffness with a width; "
                           "they are in no test.")
    if len(usable) < FEWEST_PATIENTS:
        study.notes.append(f"Nothing is tested against '{texts.name}': that needs {FEWEST_PATIENTS} patients, {len(usable)} are there.")
        return
    study.tested = usable
    study.variable = to_variable(texts.name, [texts[p] for p in usable], order)
    x, chosen = study.variable.values, patients.loc[usable]
    if np.ptp(x) < 1e-12:
        study.notes.append(f"Nothing is tested against '{texts.name}': it is the same for all patients.")
        return
    for what, y in (("mean of the pairs, kPa", chosen["mean_kpa"]), ("ln E by random effects", chosen["random_effects_ln"])):
        study.correlations += [(what, test(x, y.to_numpy(float))) for test in (pearson, spearman, kendall)]
    sd = np.hypot(chosen["random_effects_se_ln"].to_numpy(float), chosen["sd_reference"].to_numpy(float))
    ln = chosen["random_effects_ln"].to_numpy(float)
    study.regression = weighted_regression(x, ln, sd)
    labels = study.variable.classes
    for low, high in zip(sorted(labels), sorted(labels)[1:]):
        found = discrimination(x >= high, ln, f"{labels[high]} and above from {labels[low]} and below")
        if found:
            study.discriminations.append(found)


def study_of(pairs: Pairs, participants: pd.DataFrame | None = None, variable: str | None = None, order=None,
             sd_reference: float | None = None, source="") -> Study:
    """Raises CohortError where no pair has an estimate, or the variable cannot be read."""
    if len(pairs.used) == 0:
        raise CohortError(f"none of the {pairs.total} pairs has an estimate that is of the data; nothing can be said of patients")
    shared, where_from = shared_error(pairs, sd_reference)
    study = Study(pairs, patient_table(pairs.used, shared), shared, where_from)
    try:
        study.scans = repeatability(pairs.used["participant_id"], pairs.used["ln_e"])
    except CohortError as error:
        study.notes.append(f"Nothing is said of scans: {error}.")
    if participants is not None and variable is not None:
        against(study, variable_of(participants, study.patients.index, variable, source), order)
    return study


def p_text(p: float) -> str:
    return "–" if math.isnan(p) else ("< 0.0001" if p < 1e-4 else f"{p:.4f}")
