# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Many patients: from a table of image pairs to the figure of a paper (`python -m palpate.cohort --help`).

Needs pandas, SciPy, statsmodels and matplotlib, which `pip install palpate[cohort]` brings; nothing is imported before it is used.
"""
