# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Does a film of sucked tissue tell what a strip of it does when it is pulled?

  python -m tests.independent.strips --curve FILE --program PALPATE --out DIR [--seed N] [--travel MM]

A measured strip (columns stretch, nominal_stress_kPa) is fitted by Veronda-Westmann's law; a film of tissue with that law
is made by this folder's own solver and fitted by `palpate aspirate run`, which knows nothing of the strip; then the law of
the film is held to the strip, up to the largest stretch of the film's tissue. Writes `strip.json` and `strip.png`.
"""
import argparse
import importlib.machinery
import importlib.util
import json
import math
import pathlib
import shutil
import sys

import matplotlib
import numpy as np

from tests.independent import films
from tests.independent.sucked_tissue import NoEquilibrium

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

SCRIPT = pathlib.Path(__file__).parents[2] / "scripts/tissue_curves"
STRIP_STRETCH = 1.25  # up to which a strip's law is fitted
DRAWS = 4000


def tissue_curves():
    loader = importlib.machinery.SourceFileLoader("tissue_curves", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("tissue_curves", loader))
    loader.exec_module(module)
    return module


def law_of_strip(curve, program, out):
    """mu, gamma, and the strip's own stretches and stresses from its slack on."""
    module = tissue_curves()
    out.mkdir(parents=True, exist_ok=True)
    experiment = module.tension_experiment(out, curve, "veronda-westmann", STRIP_STRETCH)
    result = module.identify(program, experiment, out / "fit")
    if result is None:
        sys.exit(f"{curve}: no law of the strip")
    values = {one["path"].split(".")[-1]: one["value"] for one in result["parameters"]}
    stretch, stress = (np.array(column) for column in module.read_columns(out / "curve.csv", "stretch", "stress_kpa"))
    return values["mu_kpa"], values["gamma"], stretch, stress


def law_of_film(result):
    """Logarithms of mu and gamma that the fit allows, [draws, 2], a normal with the intervals' widths and the fit's
    correlation, and their middle."""
    places = {one["path"].split(".")[-1]: k for k, one in enumerate(result["parameters"])}
    both = [places["mu_kpa"], places["gamma"]]
    sd = []
    for k in both:
        one = result["parameters"][k]
        if one["verdict"] == "not identifiable":
            raise ValueError(f"{one['path']}: {one['value']:.3g} is not identifiable in this film")
        low, high = one["interval_95"]
        sd.append((math.log(high) - math.log(low)) / (2 * 1.96))
    correlation = np.array(result["combinations"]["correlation"])[np.ix_(both, both)]
    centre = np.log([result["parameters"][k]["value"] for k in both])
    return np.random.default_rng(1).multivariate_normal(centre, correlation * np.outer(sd, sd), DRAWS), centre


def picture(out, title, stretch, stress, predicted, band, fitted):
    figure, axes = pyplot.subplots(figsize=(6, 4.2), layout="constrained")
    axes.fill_between(stretch, *band, color="#9ecae1", label="film, 95 %")
    axes.plot(stretch, predicted, color="#08519c", label="film")
    axes.plot(stretch, fitted, "--", color="0.35", label="law of the strip")
    axes.plot(stretch, stress, ".", color="#d94801", label="strip, measured")
    axes.set(xlabel="stretch", ylabel="nominal stress, kPa", title=title)
    axes.legend(frameon=False)
    figure.savefig(out, dpi=120)
    pyplot.close(figure)


def compare(out, curve, seed, travel_mm, program, side="sliding"):
    """What the film says of the strip; written to out."""
    out.mkdir(parents=True, exist_ok=True)
    mu, gamma, stretch, stress = law_of_strip(curve, program, out / "strip")
    film = out / "film"
    truth = films.make(seed, film, side=side, tissue={"mu_kpa": mu, "gamma": gamma, "wanted_travel_mm": travel_mm})
    finished = films.fitted(program, film, film / "aspiration.toml", out / "fit")
    if not (out / "fit/result.json").exists():
        sys.exit(f"{curve}: code {finished['code']}: {finished['message'][-300:]}")
    try:
        draws, centre = law_of_film(json.loads((out / "fit/result.json").read_text()))
    except ValueError as error:
        sys.exit(f"{curve}: {error}")
    seen = stretch <= truth["largest_stretch"]
    stretch, stress = stretch[seen], stress[seen]
    at = lambda values: np.array([films.nominal_kpa(*np.exp(values), l) for l in stretch])  # noqa: E731
    all_draws = np.array([at(one) for one in draws])
    band = np.percentile(all_draws, [2.5, 97.5], axis=0)
    predicted, fitted = at(centre), at(np.log([mu, gamma]))
    largest = float(stress.max())
    told = {"strip": curve.stem, "code": finished["code"], "mu_kpa": mu, "gamma": gamma,
            "found_mu_kpa": math.exp(centre[0]), "found_gamma": math.exp(centre[1]),
            "peak_suction_kpa": truth["peak_suction_kpa"], "travel_mm": truth["travel_mm"],
            "largest_stretch": truth["largest_stretch"], "rows": int(seen.sum()),
            # of the largest stress that is compared
            "film_from_strip_percent": 100 * float(np.sqrt(np.mean((predicted - stress) ** 2))) / largest,
            "law_from_strip_percent": 100 * float(np.sqrt(np.mean((fitted - stress) ** 2))) / largest,
            "film_from_law_percent": 100 * float(np.abs(predicted - fitted).max()) / largest,
            "band_percent": 100 * float((band[1] - band[0])[-1]) / 2 / largest,
            "law_within_band_percent": 100 * float(np.mean((fitted[1:] >= band[0][1:]) & (fitted[1:] <= band[1][1:])))}
    (out / "strip.json").write_text(json.dumps(told, indent=2) + "\n")
    picture(out / "strip.png", f"{curve.stem}: {truth['travel_mm']:.2f} mm at {truth['peak_suction_kpa']:.0f} kPa",
            stretch, stress, predicted, band, fitted)
    shutil.rmtree(film / "frames")
    return told


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m tests.independent.strips", description=__doc__.splitlines()[0])
    parser.add_argument("--curve", type=pathlib.Path, required=True, help="table of a strip")
    parser.add_argument("--program", type=pathlib.Path, required=True, help="palpate")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder")
    parser.add_argument("--seed", type=int, default=801, help="of the film, but for the tissue's mu and gamma")
    parser.add_argument("--travel", type=float, default=1.0, metavar="MM", help="that the tissue comes up by, about")
    options = parser.parse_args(arguments)
    try:
        print(json.dumps(compare(options.out, options.curve, options.seed, options.travel, options.program), indent=2))
    except NoEquilibrium as error:
        sys.exit(f"no equilibrium: {error}")


if __name__ == "__main__":
    main()
