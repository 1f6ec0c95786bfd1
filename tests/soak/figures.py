# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""What a soak topic measures, and its command line: a topic is a file with `figures(long)`, which
returns a list of Figure; run by itself it prints them, with --long in full (scripts/soak), else in the
short form that CI runs (test_short_forms.py)."""
import argparse
import dataclasses
import json
import pathlib
import sys
import time


@dataclasses.dataclass
class Figure:
    number: str  # "R19" of the list of targets, docs/reliability.md
    what: str
    measured: str
    target: str
    met: bool
    detail: str = ""  # of what failed, for whoever has to mend it


def share(number, what, failures, total, target="all", needed=None):
    """A figure of `total` cases of which `failures` (a list of texts) went wrong."""
    good = total - len(failures)
    return Figure(number, what, f"{good} of {total}", target,
                  good >= (total if needed is None else needed * total) and total > 0,
                  "\n".join(failures[:20]))


def table(found):
    if not found:
        return "no figures: this topic has a long form only"
    width = max(len(figure.what) for figure in found)
    lines = [f"{'':6}{'':{width}}  {'measured':>22}  target"]
    for figure in found:
        mark = "" if figure.met else "  MISSED"
        lines.append(f"{figure.number:6}{figure.what:{width}}  {figure.measured:>22}  "
                     f"{figure.target}{mark}")
    return "\n".join(lines)


def main(figures):
    """The command line of a topic; exit code 1 if a target was missed."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--long", action="store_true", help="every case; minutes to an hour")
    parser.add_argument("--json", type=pathlib.Path, help="file for the figures, for scripts/soak")
    arguments = parser.parse_args()
    begin = time.time()
    found = figures(arguments.long)
    print(table(found))
    print(f"{time.time() - begin:.0f} s")
    for figure in found:
        if figure.detail:
            print(f"\n{figure.number} {figure.what}:\n{figure.detail}")
    if arguments.json:
        arguments.json.write_text(json.dumps([dataclasses.asdict(figure) for figure in found]))
    sys.exit(0 if all(figure.met for figure in found) else 1)
