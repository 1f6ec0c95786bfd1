# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Results that a change of the code, but not of the method, leaves as they are.

`cases.py` says what is run, `gold.json` what came out when it was recorded:

    build/venv/bin/python -m tests.gold phantoms      # makes the label volumes of tests/gold/phantoms anew
    build/venv/bin/python -m tests.gold record [CASE ...]
    build/venv/bin/python -m tests.gold compare [CASE ...]

Record only after a change that is meant to change results, and say in the commit which and why.
"""
