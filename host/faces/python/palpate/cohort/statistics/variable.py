# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Numbers for what a clinical variable says in words."""
from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from ..errors import WRONG_OPTION, CohortError

STAGE = re.compile(r"^(?P<prefix>[A-Za-z ]*?)(?P<number>\d+)(?P<part>[a-z]?)$")


@dataclass
class Variable:
    """A variable of patients as numbers.

    values   of each patient
    classes  text of each number in rising order; empty where the variable is measured, not classed
    """

    name: str
    values: np.ndarray
    classes: dict


def to_variable(name: str, texts, order=None) -> Variable:
    """texts  of each patient, none empty. Numbers stay numbers; stages such as T1, T2c, T3 become 1, 2, 3; with `order`, a list
    of the classes from low to high, places in it; two classes become 0 and 1 in the order of the alphabet.
    Raises CohortError for anything else."""
    texts = [str(text) for text in texts]
    if order:
        unknown = sorted(set(texts) - set(order))
        if unknown:
            raise CohortError(f"{name}: '{unknown[0]}' is not in the order given ({', '.join(order)})", WRONG_OPTION)
        return Variable(name, np.array([float(order.index(t)) for t in texts]), dict(enumerate(order)))
    try:
        values = np.array([float(text) for text in texts])
    except ValueError:
        values = None
    if values is not None:
        if not np.isfinite(values).all():
            raise CohortError(f"{name}: a value is not finite; write n/a where it is not known")
        few = len(set(values)) <= 6 and all(v == int(v) for v in values)
        return Variable(name, values, {v: f"{v:g}" for v in sorted(set(values))} if few else {})
    matches = [STAGE.match(text) for text in texts]
    if all(matches) and len({m["prefix"] for m in matches}) == 1:
        values = np.array([float(m["number"]) for m in matches])
        return Variable(name, values, {v: f"{matches[0]['prefix']}{v:g}" for v in sorted(set(values))})
    words = sorted(set(texts))
    if len(words) == 2:
        return Variable(name, np.array([float(words.index(t)) for t in texts]), dict(enumerate(words)))
    raise CohortError(f"{name}: '{words[0]}', '{words[-1]}' and others have no order; give it with "
                      f"--order {words[0]},...", WRONG_OPTION)
