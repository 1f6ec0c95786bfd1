# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""python -m tests.independent make | study; --help lists the options."""
import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys

from .anatomy import KINDS
from .contours import STYLES
from .loads import FAMILIES
from .phantom import make_phantom
from .score import HEAD, line_of, read_case, summary

ROOT = pathlib.Path(__file__).resolve().parents[2]


def add_common(parser):
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder")
    parser.add_argument("--load", choices=[*FAMILIES, "mixed"], help="how walls move; default: drawn")
    parser.add_argument("--anatomy", choices=KINDS, help="default: drawn")
    parser.add_argument("--contours", default="exact", metavar="WHAT",
                        help="exact; sd in mm (style and length drawn); drawn; or STYLE:SD:LENGTH in mm, STYLE one of "
                             + ", ".join(STYLES))
    parser.add_argument("--stiffness-kpa", type=float, help="default: drawn, 30 to 300")
    parser.add_argument("--size-mm", type=float, help="largest motion of a wall; default: drawn, 3 to 10")
    parser.add_argument("--spacing", type=float, nargs=3, default=[1.0, 1.0, 1.0], metavar="MM")
    parser.add_argument("--step", type=float, default=6.0, help="edge of the truth's lattice, mm (default 6)")


def read_arguments(arguments):
    parser = argparse.ArgumentParser(prog="python -m tests.independent", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    make = commands.add_parser("make", help="one phantom")
    add_common(make)
    make.add_argument("--seed", type=int, required=True)
    study = commands.add_parser("study", help="many phantoms through palpate recover")
    add_common(study)
    study.add_argument("--first-seed", type=int, default=1)
    study.add_argument("--phantoms", type=int, default=20)
    study.add_argument("--palpate", type=pathlib.Path,
                       default=os.environ.get("PALPATE", ROOT / "build/release/bin/palpate"), help="the program")
    study.add_argument("--option", action="append", default=[], metavar="TEXT",
                       help="for palpate recover, e.g. --option=--nodes=2500; may be repeated")
    study.add_argument("--keep-phantoms", action="store_true", help="keep the label volumes")
    study.add_argument("--short", action="store_true", help="two coarse phantoms")
    return parser.parse_args(arguments)


def make_from(options, seed, out):
    return make_phantom(out, seed, options.stiffness_kpa, options.anatomy, options.load, options.size_mm, options.contours,
                        options.spacing, options.step)


def study_case(options, seed):
    """The row of one seed; a case that is there is not computed again. None, with a line, if palpate gave no result."""
    folder = options.out / f"case-{seed}"
    truth, result = folder / "truth.json", folder / "result.json"
    if not result.exists():
        make_from(options, seed, folder)
        command = [str(options.palpate), "recover", folder / "reference.nii.gz", folder / "target.nii.gz", "--config",
                   folder / "organs.toml", "--out", folder / "result", "--fields", "none", "--overwrite", "--quiet",
                   *(part for text in options.option for part in text.split("=", 1))]
        run = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        if run.returncode not in (0, 7):
            print(f"{seed:>5} no result, exit code {run.returncode}: {run.stderr.strip()[-200:]}", flush=True)
            return None
        (folder / "result/result.json").replace(result)
        if not options.keep_phantoms:
            (folder / "reference.nii.gz").unlink()
            (folder / "target.nii.gz").unlink()
    row = read_case(truth, result)
    print(line_of(row), flush=True)
    return row


def run_study(options):
    if options.short:
        options.phantoms, options.spacing, options.step = 2, [2.0, 2.0, 2.0], 9.0
        options.option += ["--nodes=2500"]
    options.out.mkdir(parents=True, exist_ok=True)
    said = {key: str(value) for key, value in sorted(vars(options).items())
            if key not in ("out", "phantoms", "first_seed", "palpate", "keep_phantoms")}
    settings = options.out / "settings.json"
    if settings.exists() and json.loads(settings.read_text()) != said:
        sys.exit(f"{options.out} holds a study with other settings: choose another folder")
    settings.write_text(json.dumps(said, indent=2) + "\n")
    print(HEAD)
    seeds = range(options.first_seed, options.first_seed + options.phantoms)
    rows = [row for row in (study_case(options, seed) for seed in seeds) if row]
    if not rows:
        sys.exit("palpate gave no result for any phantom")
    with open(options.out / "cases.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    if len(rows) < options.phantoms:
        print(f"{options.phantoms - len(rows)} of {options.phantoms} phantoms gave no result")
    print("\n".join(summary(rows)))


def main(arguments=None):
    options = read_arguments(arguments)
    if options.command == "make":
        print(json.dumps(make_from(options, options.seed, options.out), indent=2))
    else:
        run_study(options)


if __name__ == "__main__":
    main()
