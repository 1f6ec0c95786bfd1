# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""How palpate's estimates and intervals stand beside the truth."""
import json
import math

import numpy as np
from scipy.stats import chi2


def read_case(truth_file, result_file):
    """One row: truth, estimate and interval (kPa; ends may be missing), verdict, hold, error and z of ln E."""
    truth = json.loads(truth_file.read_text())
    region = next(r for r in json.loads(result_file.read_text())["regions"] if r["name"] == "prostate")
    kpa, estimate = truth["stiffness_kpa"]["prostate"], region["stiffness_kpa"]
    low, high = region["interval_kpa"]
    error = math.log(estimate / kpa)
    known = low and high and high > low
    sd = math.log(high / low) / (2 * 1.96) if known else None
    return {"seed": truth["seed"], "anatomy": truth["anatomy"], "load": truth["load"]["family"],
            "motion_mm": truth["load"]["wall_motion_rms_mm"], "contours": truth["contours"]["style"],
            "contour_sd_mm": truth["contours"]["sd_mm"], "length_mm": truth["contours"]["length_mm"], "truth": kpa,
            "estimate": estimate, "low": low, "high": high, "verdict": region["verdict"],
            "hold": (low or 0) <= kpa <= (high or math.inf), "error": error, "sd": sd}


def wilson(held, count, z=1.96):
    """95 % interval of a share (Wilson 1927)."""
    share, scale = held / count, 1 + z * z / count
    middle = (share + z * z / (2 * count)) / scale
    half = z * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count)) / scale
    return max(middle - half, 0.0), min(middle + half, 1.0)


def line_of(row):
    low, high = (f"{v:.1f}" if v else "-" for v in (row["low"], row["high"]))
    drawn = f'{row["contours"]} {row["contour_sd_mm"]:.2f}/{row["length_mm"]:.0f}' if row["contour_sd_mm"] else "exact"
    return (f'{row["seed"]:>5} {row["anatomy"]:<9} {row["load"]:<9} {row["motion_mm"]:6.1f} {drawn:<19} {row["truth"]:7.1f} '
            f'{row["estimate"]:8.1f} {"[" + low + ", " + high + "]":<18} {row["verdict"]:<16} '
            f'{"yes" if row["hold"] else "NO":<4} {abs(row["error"]):6.2f}')


HEAD = (f'{"seed":>5} {"anatomy":<9} {"load":<9} {"mm rms":>6} {"contours (sd/mm)":<19} {"truth":>7} {"estimate":>8} '
        f'{"95 % interval":<18} {"verdict":<16} {"hold":<4} {"|ln|":>6}')


def summary(rows):
    """Sentences about all rows; error / claimed sd only of those with both ends."""
    errors, held = np.array([row["error"] for row in rows]), sum(row["hold"] for row in rows)
    low, high = wilson(held, len(rows))
    said = [f"{held} of {len(rows)} intervals hold the truth ({held / len(rows):.0%}; Wilson {low:.0%} to {high:.0%})",
            f"median |ln error| {np.median(np.abs(errors)):.3f}, worst {np.abs(errors).max():.2f}, bias of ln E "
            f"{errors.mean():+.3f} (standard error {errors.std(ddof=min(1, len(errors) - 1)) / math.sqrt(len(errors)):.3f})"]
    both = [row for row in rows if row["sd"]]
    if len(both) > 1:
        ratio = np.array([row["error"] / row["sd"] for row in both])
        n, spread = len(ratio) - 1, ratio.std(ddof=1)
        ends = spread * math.sqrt(n / chi2.ppf(0.975, n)), spread * math.sqrt(n / chi2.ppf(0.025, n))
        widths = [row["high"] / row["low"] for row in both]
        said.append(f"sd(error / claimed sd) {spread:.2f} (95 % {ends[0]:.2f} to {ends[1]:.2f}), mean {ratio.mean():+.2f}, "
                    f"root mean square {np.sqrt((ratio ** 2).mean()):.2f}; median width x{np.median(widths):.2f}, "
                    f"narrowest x{min(widths):.2f}")
    return said
