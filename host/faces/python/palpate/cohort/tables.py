# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Reads the two tables of a cohort: a row a pair (pairs.tsv), a row a patient (participants.tsv).

Identifiers are text: `NA`, `nan` and `007` stay what they are.
"""
from __future__ import annotations

import pathlib
from dataclasses import dataclass

import numpy as np
import pandas as pd

from .errors import DAMAGED_FILE, WRONG_OPTION, CohortError

PAIR_NUMBERS = ("e_kpa", "ln_e", "sd_ln", "e_low_kpa", "e_high_kpa", "ln_e_data", "sd_data")
PAIR_COLUMNS = ("participant_id", "reference", "target", "status", "code", "verdict", "region",
                "e_kpa", "ln_e", "sd_ln", "ln_e_data", "sd_data")
NO_VALUE = ("", "n/a")
TOLD = ("recovered", "weak")  # verdicts whose estimate is of the data


def read_table(path) -> pd.DataFrame:
    """All cells as text. Commas where the name ends in .csv, tabs elsewhere; UTF-8, a byte order mark is allowed.

    Raises CohortError for a file that is missing, is no table, or names a column twice.
    """
    path = pathlib.Path(path)
    separator = "," if path.suffix.lower() == ".csv" else "\t"
    try:
        # The header is read as a row, because pandas renames the second of two equal columns.
        rows = pd.read_csv(path, sep=separator, header=None, dtype=str, keep_default_na=False,
                           encoding="utf-8-sig", index_col=False)
    except (OSError, UnicodeDecodeError, pd.errors.ParserError, pd.errors.EmptyDataError) as error:
        raise CohortError(f"{path}: no table can be read ({str(error).strip()}); a tab-separated (.tsv) or "
                          "comma-separated (.csv) file in UTF-8 with a header is needed", DAMAGED_FILE) from error
    names = [name.strip() for name in rows.iloc[0]]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise CohortError(f"{path}: the header names '{twice[0]}' twice; rename one of them")
    table = rows.iloc[1:].reset_index(drop=True)
    table.columns = names
    return table


def require_columns(table: pd.DataFrame, columns, path) -> None:
    missing = [name for name in columns if name not in table.columns]
    if missing:
        raise CohortError(f"{path}: there is no column '{missing[0]}'; the header has {', '.join(table.columns)}")


def to_numbers(cells: pd.Series, path) -> np.ndarray:
    """Floats; NaN for a cell without value. Raises CohortError naming row and column of what is no number."""
    numbers = np.full(len(cells), np.nan)
    for row, text in enumerate(cells):
        if text.strip() in NO_VALUE:
            continue
        try:
            numbers[row] = float(text)
        except ValueError:
            raise CohortError(f"{path}, row {row + 2}, column {cells.name}: '{text}' is no number") from None
    return numbers


@dataclass
class Pairs:
    """What enters the statistics, and what does not and why.

    used      rows with an estimate of the data; numbers are floats
    excluded  participant_id, reference, target, reason
    region    the organ
    """

    used: pd.DataFrame
    excluded: pd.DataFrame
    region: str

    @property
    def total(self) -> int:
        return len(self.used) + len(self.excluded)


def reason_to_exclude(row) -> str:
    """Empty where the row's estimate enters. *Not identifiable* never does: it is the prior. *Weak* does, with its width."""
    if row["status"] == "excluded":
        return "left out by the table"
    if row["status"] == "waiting":
        return "not calculated yet"
    if row["status"] == "stale":
        return "of other settings or inputs than planned"
    if row["code"] == "7":
        return "search did not converge"
    if row["code"] not in ("", "0", "n/a"):
        return f"failed with code {row['code']}"
    if row.get("rating", "") == "reject":
        return "rejected in the gallery"
    if row["verdict"] not in TOLD:
        return row["verdict"] or "no estimate"
    if not (np.isfinite(row["e_kpa"]) and row["e_kpa"] > 0 and np.isfinite(row["ln_e"])):
        return "no estimate"
    return ""


def one_region(table: pd.DataFrame, region: str | None, path) -> tuple[pd.DataFrame, str]:
    """Rows of the organ, and rows of cases that failed before any organ was known."""
    known = sorted(set(table["region"]) - set(NO_VALUE))
    if region is None:
        if len(known) > 1:
            raise CohortError(f"{path} has several organs; choose one with --region: {', '.join(known)}", WRONG_OPTION)
        region = known[0] if known else ""
    elif region not in known:
        raise CohortError(f"{path}: there is no region '{region}'; there are {', '.join(known)}", WRONG_OPTION)
    return table[(table["region"] == region) | table["region"].isin(NO_VALUE)], region


def read_pairs(path, region: str | None = None) -> Pairs:
    """Rows of one organ of pairs.tsv, sorted into what enters the statistics and what does not."""
    table = read_table(path)
    require_columns(table, PAIR_COLUMNS, path)
    for name in PAIR_NUMBERS:
        if name in table.columns:
            table[name] = to_numbers(table[name], path)
    table, region = one_region(table, region, path)
    reasons = pd.Series([reason_to_exclude(row) for _, row in table.iterrows()], index=table.index, dtype=object)
    excluded = table.loc[reasons != "", ["participant_id", "reference", "target"]].assign(reason=reasons[reasons != ""])
    return Pairs(table[reasons == ""].reset_index(drop=True), excluded.reset_index(drop=True), region)


def read_participants(path) -> pd.DataFrame:
    """Clinical variables by participant_id, as text. An id may have the prefix `sub-` here and not in the pairs."""
    table = read_table(path)
    require_columns(table, ["participant_id"], path)
    ids = table["participant_id"]
    if ids.duplicated().any():
        raise CohortError(f"{path}: participant_id '{ids[ids.duplicated()].iloc[0]}' stands twice; one row a patient")
    short = ids.str.removeprefix("sub-")
    if short.duplicated().any():
        both = sorted(ids[short == short[short.duplicated()].iloc[0]])
        raise CohortError(f"{path}: participant_id '{both[0]}' and '{both[1]}' are the same patient, with and without 'sub-'; "
                          "keep one of them")
    return table.set_index("participant_id")


def variable_of(participants: pd.DataFrame, ids, variable: str, path) -> pd.Series:
    """Text of a clinical variable for each id, in the order of `ids`; empty where there is none."""
    if variable not in participants.columns:
        raise CohortError(f"{path}: there is no column '{variable}'; the header has "
                          f"{', '.join(participants.columns)}", WRONG_OPTION)
    column = participants[variable]
    by_id = {**{str(k).removeprefix("sub-"): v for k, v in column.items()}, **dict(column.items())}
    texts = [by_id.get(i, by_id.get(str(i).removeprefix("sub-"), "")).strip() for i in ids]
    return pd.Series(["" if text in NO_VALUE else text for text in texts], index=list(ids), dtype=object, name=variable)
