# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""What a table or an option is refused for."""
from .._core import PalpateError

WRONG_OPTION, DAMAGED_FILE, UNUSABLE_INPUT, NOT_CONVERGED, DEVICE_FAILED, STOPPED, OUTPUT_FAILED = 2, 3, 4, 7, 8, 9, 10


class CohortError(PalpateError):
    """One sentence: what, where, what to do. `status` is the exit code of the command line (docs/errors.md)."""

    def __init__(self, sentence: str, status: int = UNUSABLE_INPUT):
        super().__init__(sentence)
        self.status = status
