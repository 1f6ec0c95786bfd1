#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""R17: loads that invert matter, tissue that keeps its volume and moduli from 1e-6 to 1e6 kPa: solved, or
told and flagged; never a number in a result that is none."""
import itertools
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent))
import numpy  # noqa: E402

from tests.soak.figures import Figure, main, share  # noqa: E402
from tests.soak.runs import Scene, box_model, in_parallel, run  # noqa: E402
from tests.vtu import read_arrays  # noqa: E402

SIZE_MM = 10
USUAL_PULL_MM, USUAL_PRESS_MM = 1.0, 0.4


def not_finite(out):
    """Names of what is not finite in a result folder."""
    found = []
    for path in sorted(out.glob("*.vtu")):
        found += [f"{path.name}: {name}" for name, values in read_arrays(path).items()
                  if not numpy.isfinite(numpy.asarray(values, float)).all()]
    for path in (out / "reactions.csv", out / "simulation.json"):
        words = path.read_text().lower().replace('"', " ").replace(",", " ").split()
        found += [path.name for word in words
                  if word in ("nan", "-nan", "inf", "-inf")][:1]
    return found


def cases(long):
    """(Poisson's ratio, modulus, pull, quadratic): ten times the load on linear tetrahedra, the usual one on
    quadratic ones. Linear ones lock at 0.4999: stretched by a tenth they lose their stability at 85 % of
    that, which is told."""
    ratios = [0.3, 0.4999]
    moduli = [10.0 ** k for k in (range(-6, 7) if long else (-6, 0, 6))]
    loads = [(10 * USUAL_PULL_MM, False), (-10 * USUAL_PRESS_MM, False)] + [(USUAL_PULL_MM, True)] * long
    return [(*case, *load) for case, load in itertools.product(itertools.product(ratios, moduli), loads)]


def figures(long):
    with Scene() as scene:
        def case(parameters):
            ratio, modulus, pull, quadratic = parameters
            work = scene.fresh()
            model = work / "model.toml"
            model.write_text(box_model(SIZE_MM, 4, "neo-hookean", modulus, ratio, pull, quadratic))
            finished = run("simulate", model, "--out", work / "out", "--quiet", limit_s=300)
            name = f"{'quadratic' if quadratic else 'linear'}, nu {ratio}, E {modulus:g} kPa, pulled by {pull:g} of {SIZE_MM} mm"
            told = finished.code in (0, 6, 7)
            bad = not_finite(work / "out") if (work / "out").exists() else []
            return (None if finished.code == 0 else f"{name}: {finished}",
                    None if told else f"{name}: {finished}",
                    f"{name}: {bad}" if bad else None)
        chosen = cases(long)
        results = in_parallel(case, chosen)
        unsolved, untold, bad = ([text for text in column if text] for column in zip(*results))
        return [share("R17", "ten times the load, nu 0.4999, E 1e-6 to 1e6", unsolved, len(chosen),
                      ">= 90 % solved", 0.9),
                share("R17", "the others end with code 6 or 7", untold, len(chosen), "all"),
                Figure("R17", "results with numbers that are none", str(len(bad)), "0", not bad,
                       "\n".join(bad))]


if __name__ == "__main__":
    main(figures)
