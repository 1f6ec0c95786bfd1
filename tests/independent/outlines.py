# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""How well `palpate aspirate contours` finds the outlines of films that silhouettes.py draws.

    build/venv/bin/python -m tests.independent.outlines --first-seed 313 --films 12 [--program palpate]

A line of Markdown for each kind of frames: errors of points without a flag and within 3 pixels, points beyond that
without a flag, flagged points, how many errors are within 1.96 of the claimed sd, and films that are refused (of which no
point counts). Points less than 6 rows above the line of visibility do not count. About two minutes for 12 films."""
import argparse
import collections
import math
import pathlib
import subprocess
import tempfile

from . import silhouettes

FRAMES, RATE_HZ, WRONG_PX, MARGIN_ROWS, MARGIN_COLUMNS = 16, 25, 3, 6, 4
AXIS_COLUMN = (silhouettes.SIDE - 1) / 2
SETTINGS = f"""[instrument]
hole_diameter_mm = {silhouettes.HOLE_MM}
edge_radius_mm = 0.2
rim_thickness_mm = {silhouettes.RIM_MM}
pixel_r_um = {1000 * silhouettes.PIXEL_R_MM}
pixel_z_um = {1000 * silhouettes.PIXEL_Z_MM}
base_row_px = {silhouettes.BASE_ROW}
axis_column_px = {AXIS_COLUMN}
[frames]
rate_hz = {RATE_HZ}
"""


def add_film(kind, seed, program, config, sums):
    frames, truths = zip(*silhouettes.film(kind, seed, FRAMES))
    size = f"{silhouettes.SIDE}x{silhouettes.SIDE}"
    found = subprocess.run([program, "aspirate", "contours", "-", "--raw", size, "--config", config, "--quiet"],
                           input=b"".join(frame.tobytes() for frame in frames), capture_output=True)
    if found.returncode != 0:
        sums["refused"] += 1
        return
    for line in found.stdout.decode().splitlines():
        if not line[:1].isdigit():
            continue
        time_s, r_mm, z_mm, sd_mm, flag = map(float, line.split(","))
        column = round(r_mm / silhouettes.PIXEL_R_MM + AXIS_COLUMN)
        truth = truths[round(time_s * RATE_HZ)][column]
        inside = MARGIN_COLUMNS <= column < silhouettes.SIDE - MARGIN_COLUMNS
        if truth > silhouettes.VISIBLE_ROWS - MARGIN_ROWS or not inside:
            continue
        error = silhouettes.BASE_ROW - z_mm / silhouettes.PIXEL_Z_MM - truth
        sums["points"] += 1
        if flag:
            sums["flagged"] += 1
        elif abs(error) > WRONG_PX:
            sums["wrong"] += 1
        else:
            sums["near"] += 1
            sums["error"] += error
            sums["squares"] += error**2
            sums["held"] += abs(error) <= 1.96 * sd_mm / silhouettes.PIXEL_Z_MM


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first-seed", type=int, default=301)
    parser.add_argument("--films", type=int, default=12)
    parser.add_argument("--program", default="build/release/bin/palpate")
    arguments = parser.parse_args()
    print("| frames | rms, px | bias, px | beyond 3 px, no flag | flagged | within 1.96 sd | films refused |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        config = pathlib.Path(folder) / "film.toml"
        config.write_text(SETTINGS)
        for kind in silhouettes.SUITE:
            sums = collections.Counter()
            for seed in range(arguments.first_seed, arguments.first_seed + arguments.films):
                add_film(kind, seed, arguments.program, config, sums)
            near, points = max(1, sums["near"]), max(1, sums["points"])
            print(f"| {kind.name} | {math.sqrt(sums['squares'] / near):.2f} | {sums['error'] / near:+.2f} "
                  f"| {100 * sums['wrong'] / points:.2f} % | {100 * sums['flagged'] / points:.1f} % "
                  f"| {100 * sums['held'] / near:.0f} % | {sums['refused']} |", flush=True)


if __name__ == "__main__":
    main()
