# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate-bids BIDS_DIR OUTPUT_DIR {participant,group}: a cohort as a BIDS App.

`participant` finds the label volumes, plans once and recovers (all participants, or those of --participant_label, also in
several processes at a time). `group` collects; it needs no images. Label volumes are not in the core of BIDS: what is
looked for is the derivative `*_dseg.nii.gz`, one for each session of a participant.
"""
from __future__ import annotations

import argparse
import fcntl
import os
import pathlib
import shutil
import subprocess
import sys

from .errors import UNUSABLE_INPUT, WRONG_OPTION, CohortError

HEADER = "participant_id\tsession_id\treference\ttarget"


def arguments_of(command) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="palpate-bids", description=__doc__.split("\n")[0])
    parser.add_argument("bids_dir", help="folder of sub-*/[ses-*/]; `group` does not read it")
    parser.add_argument("output_dir", help="gets pairs.tsv, cohort/ and report/")
    parser.add_argument("analysis_level", choices=("participant", "group"))
    parser.add_argument("--participant_label", nargs="+", default=[], metavar="LABEL", help="with or without sub-; default: all")
    parser.add_argument("--settings", metavar="FILE", help="organs (TOML); needed by participant")
    parser.add_argument("--config", metavar="FILE", help="cohort.toml")
    parser.add_argument("--pattern", default="*_dseg.nii.gz", help="of label volumes within a session; default %(default)s")
    parser.add_argument("--reference-session", metavar="LABEL", help="default: the first by name")
    parser.add_argument("--n_cpus", type=int, default=1, metavar="N", help="patients at a time")
    parser.add_argument("--against", metavar="COLUMN", help="of participants.tsv in BIDS_DIR: what the report tests stiffness against")
    parser.add_argument("--program", metavar="FILE", help="palpate; default: $PALPATE, or the first of PATH")
    parser.add_argument("--test-stub", help=argparse.SUPPRESS)
    return parser.parse_args(command)


def volume_of(folder: pathlib.Path, pattern: str) -> pathlib.Path | None:
    found = sorted(path for path in folder.rglob(pattern) if path.is_file())
    if len(found) > 1:
        raise CohortError(f"{folder} has several label volumes ({found[0].name}, {found[1].name}); choose with --pattern", WRONG_OPTION)
    return found[0] if found else None


def rows_of(bids: pathlib.Path, pattern: str, reference_session: str | None) -> list:
    """A row of the table of pairs for every session of a participant but that of the reference."""
    rows = []
    for subject in sorted(path for path in bids.glob("sub-*") if path.is_dir()):
        sessions = {path.name.removeprefix("ses-"): volume_of(path, pattern) for path in sorted(subject.glob("ses-*")) if path.is_dir()}
        sessions = {name: volume for name, volume in sessions.items() if volume}
        if len(sessions) < 2:
            print(f"palpate-bids: {subject.name} has {len(sessions)} sessions with label volumes and is left out; two are needed", file=sys.stderr)
            continue
        reference = reference_session or next(iter(sessions))
        if reference not in sessions:
            print(f"palpate-bids: {subject.name} has no session {reference} with a label volume and is left out", file=sys.stderr)
            continue
        rows += [(subject.name.removeprefix("sub-"), name, sessions[reference].resolve(), volume.resolve())
                 for name, volume in sessions.items() if name != reference]
    if not rows:
        raise CohortError(f"{bids}: no participant has two sessions with {pattern}; sub-*/ses-*/**/{pattern} is looked for", UNUSABLE_INPUT)
    return rows


def program_of(chosen) -> str:
    program = chosen.program or os.environ.get("PALPATE") or shutil.which("palpate")
    if not program:
        raise CohortError("there is no palpate in PATH; name it with --program", WRONG_OPTION)
    return program


def call(program, *words) -> int:
    return subprocess.run([program, "cohort", *map(str, words)]).returncode


def plan(chosen, out: pathlib.Path) -> int:
    """Plans, unless the same table is planned already. For one process at a time."""
    if not chosen.settings:
        raise CohortError("--settings is missing: the organs of the label volumes (TOML)", WRONG_OPTION)
    rows = rows_of(pathlib.Path(chosen.bids_dir), chosen.pattern, chosen.reference_session)
    text = "\n".join([HEADER, *("\t".join(map(str, row)) for row in rows)]) + "\n"
    table, cohort = out / "pairs.tsv", out / "cohort"
    with open(out / ".plan.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        is_planned = (cohort / "plan.json").exists() and table.exists() and table.read_text(encoding="utf-8") == text
        if is_planned:
            return 0
        table.write_text(text, encoding="utf-8")
        words = ["plan", table, "--out", cohort, "--settings", chosen.settings, "--quiet", "--overwrite"]
        words += ["--config", chosen.config] if chosen.config else []
        words += ["--test-stub", chosen.test_stub] if chosen.test_stub else []
        code = call(program_of(chosen), *words)
        if code:
            table.unlink()
        return code


def participant(chosen, out: pathlib.Path) -> int:
    out.mkdir(parents=True, exist_ok=True)
    code = plan(chosen, out)
    if code:
        return code
    only = [label.removeprefix("sub-") for label in chosen.participant_label]
    return call(program_of(chosen), "run", out / "cohort", "--jobs", chosen.n_cpus, *(["--only", *only] if only else []))


def group(chosen, out: pathlib.Path) -> int:
    code = call(program_of(chosen), "collect", out / "cohort")
    if code:
        return code
    from .__main__ import main as cohort_main

    report = out / "report"
    if (report / "statistics.json").exists():
        shutil.rmtree(report)
    people = pathlib.Path(chosen.bids_dir) / "participants.tsv"
    against = ["--participants", people, "--against", chosen.against] if chosen.against else []
    return cohort_main([str(word) for word in ["report", out / "cohort", "--out", report, *against]])


def main(command=None) -> int:
    chosen = arguments_of(command)
    try:
        if chosen.n_cpus < 1:
            raise CohortError(f"--n_cpus {chosen.n_cpus}: allowed are 1 and more", WRONG_OPTION)
        out = pathlib.Path(chosen.output_dir)
        return participant(chosen, out) if chosen.analysis_level == "participant" else group(chosen, out)
    except CohortError as error:
        print(f"palpate-bids: {error}", file=sys.stderr)
        return error.status
    except OSError as error:
        print(f"palpate-bids: {error.filename}: {error.strerror}", file=sys.stderr)
        return 10


if __name__ == "__main__":
    sys.exit(main())
