# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""python -m palpate.cohort dask COHORT: a planned cohort on the workers of Dask.
python -m palpate.cohort report PAIRS.tsv --out FOLDER: what a cohort says of patients."""
from __future__ import annotations

import argparse
import pathlib
import sys


def arguments_of(command) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m palpate.cohort", description="From a table of pairs to the figure of a paper.")
    commands = parser.add_subparsers(dest="command", required=True)
    add_dask(commands)
    add_report(commands)
    return parser.parse_args(command)


def add_dask(commands) -> None:
    dask = commands.add_parser("dask", help="run a planned cohort on the workers of a Dask scheduler")
    dask.add_argument("cohort", help="folder of `palpate cohort plan`, seen by all workers under the same name")
    where = dask.add_mutually_exclusive_group()
    where.add_argument("--scheduler-file", metavar="FILE", help="as of `dask scheduler --scheduler-file`")
    where.add_argument("--scheduler", metavar="ADDRESS", help="tcp://host:8786")
    where.add_argument("--jobs", type=int, default=1, metavar="N", help="without a scheduler: workers on this machine")
    dask.add_argument("--program", metavar="FILE", help="palpate on the workers; default: $PALPATE, or the first of PATH")
    dask.set_defaults(run=dask_run)


def add_report(commands) -> None:
    report = commands.add_parser("report", help="a page of patients, tests against a clinical variable, and scans")
    report.add_argument("pairs", help="pairs.tsv of `palpate cohort collect`, or the folder of the cohort")
    report.add_argument("--out", required=True, help="new folder for index.html, patients.tsv and statistics.json")
    report.add_argument("--region", help="the organ, where there are several")
    report.add_argument("--participants", help="clinical variables, a row a patient (participants.tsv)")
    report.add_argument("--against", metavar="COLUMN", help="column of --participants to test stiffness against")
    report.add_argument("--order", help="its classes from low to high, with commas, where text does not say it")
    report.add_argument("--sd-reference", type=float, metavar="SD",
                        help="sd of ln E that all pairs share through one reference; without it, from patients with several references")
    report.add_argument("--title", default="Stiffness of a cohort")
    report.set_defaults(run=report_run)


def dask_run(chosen: argparse.Namespace) -> int:
    from .dask_engine import run_on_dask
    from .errors import STOPPED, WRONG_OPTION, CohortError

    if chosen.jobs < 1:
        raise CohortError(f"--jobs {chosen.jobs}: allowed are 1 and more", WRONG_OPTION)
    try:
        return run_on_dask(chosen)
    except KeyboardInterrupt:
        raise CohortError("stopped; what is done stays: the same command goes on", STOPPED) from None


def report_run(chosen: argparse.Namespace) -> int:
    from .errors import WRONG_OPTION, CohortError
    from .report import write_report
    from .study import study_of
    from .tables import read_pairs, read_participants

    if (chosen.against is None) != (chosen.participants is None):
        raise CohortError("--against and --participants go together: a column, and the table that has it", WRONG_OPTION)
    if chosen.sd_reference is not None and not 0 <= chosen.sd_reference < 3:
        raise CohortError(f"--sd-reference {chosen.sd_reference:g}: allowed are 0 to 3, of ln E", WRONG_OPTION)
    path = pathlib.Path(chosen.pairs)
    path = path / "pairs.tsv" if path.is_dir() else path
    participants = read_participants(chosen.participants) if chosen.participants else None
    order = [name.strip() for name in chosen.order.split(",")] if chosen.order else None
    study = study_of(read_pairs(path, chosen.region), participants, chosen.against, order, chosen.sd_reference, chosen.participants)
    write_report(study, chosen.out, chosen.title)
    print(f"{len(study.pairs.used)} of {study.pairs.total} pairs, {len(study.patients)} patients: {pathlib.Path(chosen.out) / 'index.html'}")
    return 0


def main(command=None) -> int:
    chosen = arguments_of(command)
    try:
        from .._core import PalpateError

        return chosen.run(chosen)
    except ImportError as error:
        extra = "dask" if chosen.command == "dask" else "cohort"
        print(f"palpate.cohort: {error.name} is missing; pip install 'palpate[{extra}]'", file=sys.stderr)
        return 2
    except PalpateError as error:
        print(f"palpate.cohort: {error}", file=sys.stderr)
        return getattr(error, "status", 1)


if __name__ == "__main__":
    sys.exit(main())
