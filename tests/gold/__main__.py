# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
import argparse
import json
import pathlib
import tempfile
import time

from tests.gold import cases
from tests.gold.test_gold import GOLD, recorded


def main():
    parser = argparse.ArgumentParser(prog="python -m tests.gold")
    parser.add_argument("action", choices=("phantoms", "record", "compare"))
    parser.add_argument("case", nargs="*", choices=[[], *cases.CASES])
    arguments = parser.parse_args()
    if arguments.action == "phantoms":
        cases.make_phantoms()
        return
    gold = recorded() if GOLD.exists() else {}
    for name in arguments.case or cases.CASES:
        if cases.missing_data(name):
            print(f"{name}: no data in {cases.missing_data(name)}")
            continue
        start = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            figures = cases.CASES[name](pathlib.Path(folder))
        print(f"{name}: {time.monotonic() - start:.1f} s", flush=True)
        for line in cases.differences(figures, gold.get(name, {})) if name in gold else ["not recorded before"]:
            print(f"    {line}")
        if arguments.action == "record":
            gold[name] = figures
            GOLD.write_text(json.dumps(gold, indent=1) + "\n")


main()
