# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Inference about patients from a table of pairs: pure functions, no files.

The unit of every test is the patient, never the pair: pairs of one patient are no independent witnesses of it.
Everything but the published mean and sd is calculated in ln E (E in kPa).
"""
from .association import (Correlation, bootstrap_interval, kendall, num_arrangements, p_of_correlation, pearson,
                          permutation_p, spearman)
from .discrimination import Discrimination, discrimination
from .patients import LnEstimate, arithmetic, joint, patient_table, random_effects
from .reference_error import ReferenceError, reference_error_from_images, reference_error_from_truth
from .regression import Regression, weighted_regression
from .repeatability import Repeatability, repeatability
from .variable import Variable, to_variable

__all__ = ["Correlation", "Discrimination", "LnEstimate", "ReferenceError", "Regression", "Repeatability", "Variable",
           "arithmetic", "bootstrap_interval", "discrimination", "joint", "kendall", "num_arrangements",
           "p_of_correlation", "patient_table", "pearson", "permutation_p", "random_effects",
           "reference_error_from_images", "reference_error_from_truth", "repeatability", "spearman", "to_variable",
           "weighted_regression"]
