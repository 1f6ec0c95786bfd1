#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Recovers the prostate's stiffness in phantoms with known answers and sets truth beside estimate.

    scripts/phantom_study.py --out study             ten phantoms, 40 to 350 kPa, 1 mm voxels
    scripts/phantom_study.py --out study --only 2    the first two

Needs build/release/bin/palpate, numpy and nibabel. A phantom that is there already is used again; a
result that is there already is read again, so an interrupted study goes on where it stopped.
"""
import argparse
import csv
import json
import pathlib
import subprocess
import sys
import time

import nibabel
import numpy

ROOT = pathlib.Path(__file__).resolve().parent.parent
STIFFNESS_KPA = [40, 55, 70, 90, 115, 145, 180, 225, 280, 350]


def run(arguments):
    """Runs palpate; exit code 7 (not converged, result written) is allowed."""
    finished = subprocess.run([str(item) for item in arguments], capture_output=True, text=True)
    if finished.returncode not in (0, 7):
        sys.exit(f"{' '.join(map(str, arguments))}\n{finished.stderr}")


def landmark_errors_mm(phantom, result):
    """Distance between true and recovered displacement at the landmarks, mm."""
    rows = numpy.loadtxt(phantom / "landmarks.csv", delimiter=",", skiprows=1)
    image = nibabel.load(result / "displacement.nii.gz")
    field = numpy.asarray(image.dataobj).reshape(*image.shape[:3], 3)
    points_ras = rows[:, :3] * [-1, -1, 1]
    index = nibabel.affines.apply_affine(numpy.linalg.inv(image.affine), points_ras)
    low = numpy.clip(numpy.floor(index).astype(int), 0, numpy.array(image.shape[:3]) - 2)
    fraction = index - low
    found = numpy.zeros((len(rows), 3))
    for corner in numpy.ndindex(2, 2, 2):
        weight = numpy.prod(numpy.where(corner, fraction, 1 - fraction), axis=1)
        at = low + corner
        found += weight[:, None] * field[at[:, 0], at[:, 1], at[:, 2]]
    return numpy.linalg.norm(found - rows[:, 3:6], axis=1)


def study_one(palpate, folder, seed, stiffness_kpa, spacing, extra):
    phantom = folder / f"phantom_{seed}_{stiffness_kpa}_{'x'.join(f'{s:g}' for s in spacing)}"
    result = folder / f"result_{phantom.name.removeprefix('phantom_')}"
    if not phantom.exists():
        run([palpate, "phantom", "pelvis", "--seed", seed, "--stiffness-kpa", stiffness_kpa,
             "--spacing", *spacing, "--out", phantom, "--quiet"])
    begin = time.monotonic()
    if not result.exists():
        run([palpate, "recover", phantom / "reference.nii.gz", phantom / "target.nii.gz",
             "--config", phantom / "organs.toml", "--out", result, "--quiet", *extra])
    seconds = time.monotonic() - begin
    report = json.loads((result / "result.json").read_text())
    prostate = next(r for r in report["regions"] if r["name"] == "prostate")
    errors = landmark_errors_mm(phantom, result)
    low, high = prostate["interval_kpa"]
    return {
        "seed": seed, "true_kpa": stiffness_kpa,
        "found_kpa": round(prostate["stiffness_kpa"], 2),
        "error_percent": round(100 * (prostate["stiffness_kpa"] / stiffness_kpa - 1), 1),
        "low_kpa": round(low, 2), "high_kpa": round(high, 2),
        "holds_truth": bool(low <= stiffness_kpa <= high), "verdict": prostate["verdict"],
        "landmark_mean_mm": round(float(errors.mean()), 3),
        "landmark_max_mm": round(float(errors.max()), 3),
        "converged": report["termination"]["converged"],
        "iterations": report["termination"]["iterations"],
        "seconds": round(report["timings_s"]["total"] if seconds < 1 else seconds, 1),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--only", type=int, default=len(STIFFNESS_KPA), help="how many phantoms")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--spacing", type=float, nargs=3, default=[1.0, 1.0, 1.0], help="mm")
    parser.add_argument("--palpate", default=ROOT / "build/release/bin/palpate")
    parser.add_argument("extra", nargs="*", help="further arguments of recover, after --")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)

    rows = []
    for number, stiffness_kpa in enumerate(STIFFNESS_KPA[:options.only]):
        row = study_one(options.palpate, options.out, options.first_seed + number, stiffness_kpa,
                        options.spacing, options.extra)
        rows.append(row)
        print(f"seed {row['seed']:3d}  true {row['true_kpa']:4d} kPa  found {row['found_kpa']:7.1f} "
              f"({row['error_percent']:+6.1f} %)  95 % {row['low_kpa']:7.1f} to {row['high_kpa']:7.1f} "
              f"{'holds ' if row['holds_truth'] else 'misses'}  {row['verdict']:<16} landmarks "
              f"{row['landmark_mean_mm']:.2f} mm  {row['iterations']:2d} it  {row['seconds']:.0f} s",
              flush=True)
    with open(options.out / "study.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    worst = max(abs(row["error_percent"]) for row in rows)
    signed = sum(row["error_percent"] for row in rows) / len(rows)
    print(f"worst error {worst:.1f} %, mean signed error {signed:+.1f} %, interval holds the truth in "
          f"{sum(row['holds_truth'] for row in rows)} of {len(rows)}, worst landmark mean "
          f"{max(row['landmark_mean_mm'] for row in rows):.2f} mm; {options.out / 'study.csv'}")


if __name__ == "__main__":
    main()
