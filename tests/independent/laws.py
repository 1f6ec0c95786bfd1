# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Does a film tell what law its tissue follows, and with how many terms it relaxes? Films of films.py of other tissues.

    python -m tests.independent.laws --first-seed 901 --films 24 --out DIR --program PATH [--jobs 1] [--terms 1 2]

The law goes by turns with the seed, the number of terms (one, two) with each third seed. palpate is told neither: it
compares three laws with each number of terms that --terms names. Films that are done are not made or fitted again.
DIR/table.md holds what came out, DIR/film-SEED the film's truth and the fit.
"""
import argparse
import concurrent.futures
import json
import math
import pathlib
import re
import shutil
import statistics
import sys

import numpy as np

from . import films
from .sucked_tissue import NoEquilibrium

LAWS = ("veronda-westmann", "neo-hookean-reduced", "reduced-polynomial")


def tissue_of(seed):
    """What of films.draw_truth(seed) another law and more terms replace.

    Of the polynomial, gamma says how it stiffens at first, as Veronda-Westmann's does: C1 = mu, C2 = mu gamma / 2."""
    random, drawn = np.random.default_rng([5113, seed, 2]), films.draw_truth(seed)
    tissue = {"law": LAWS[seed % 3]}
    if tissue["law"] == "neo-hookean-reduced":
        tissue["gamma"] = 0.0
    elif tissue["law"] == "reduced-polynomial":
        tissue |= {"c1_kpa": drawn["mu_kpa"], "c2_kpa": drawn["mu_kpa"] * drawn["gamma"] / 2}
    if seed // 3 % 2:
        tissue |= {"time_s": 0.25 * math.exp(random.uniform(0, math.log(3.2))),
                   "more_terms": [{"amplitude": 0.15 + 0.5 * random.beta(2, 2.5),
                                   "time_s": 2.5 * math.exp(random.uniform(0, math.log(3.2)))}]}
    return tissue


def numbers_of(truth):
    """Of the model that is true, by the ends of palpate's paths."""
    elastic = {"veronda-westmann": ["mu_kpa", "gamma"], "neo-hookean-reduced": ["mu_kpa"],
               "reduced-polynomial": ["c1_kpa", "c2_kpa"]}[truth["law"]]
    numbers = {f"material[1].{name}": truth[name] for name in elastic}
    for k, term in enumerate([truth, *truth.get("more_terms", [])], 1):
        for name in ("amplitude", "time_s"):
            numbers[f"material[1].relaxation[{k}].{name}"] = term[name]
    return numbers


def settings_of(film, terms):
    """Those of a film, but that every law is asked for."""
    settings = (film / "aspiration.toml").read_text()
    for key, asked in (("laws", LAWS), ("relaxation_terms", terms)):
        settings, count = re.subn(rf"^{key} = .*$", f"{key} = {json.dumps(asked)}", settings, flags=re.MULTILINE)
        assert count == 1
    return settings


def study_film(options, seed):
    """Makes and fits one film unless that is done; what came out."""
    folder = options.out / f"film-{seed}"
    film, outcome = folder / "film", folder / "outcome.json"
    if not outcome.exists():
        said = {"seed": seed, "code": None, "message": ""}
        try:
            if not (film / "truth.json").exists():
                films.make(seed, film, side="held" if seed % 2 else "sliding", tissue=tissue_of(seed))
            (folder / "aspiration.toml").write_text(settings_of(film, options.terms))
            shutil.rmtree(folder / "fit", ignore_errors=True)  # of a study that was stopped
            said |= films.fitted(options.program, film, folder / "aspiration.toml", folder / "fit")
            if said["code"] < 0:
                raise RuntimeError(f"film {seed}: the fit was stopped by signal {-said['code']}")
        except NoEquilibrium as error:
            said["message"] = f"no film: {error}"
        outcome.write_text(json.dumps(said, indent=2) + "\n")
        if not options.keep:
            shutil.rmtree(film / "frames", ignore_errors=True)
    return read_film(folder)


def model_named(name):
    """("veronda-westmann", 2) of "veronda-westmann, 2 relaxation terms"."""
    law, count = re.fullmatch(r"(\S+), (\d+) relaxation terms?", name).groups()
    return law, int(count)


def read_film(folder):
    """{"seed", "code", "model", "truth", "evidence": {(law, terms): ln}, "first": (law, terms), "found"} of a folder;
    without a result the last four are empty. found: [(path, true, value, low, high)] where the true model is first."""
    case = json.loads((folder / "outcome.json").read_text()) | {"truth": None, "evidence": {}, "first": None, "found": []}
    case["model"] = true_model(tissue_of(case["seed"]))
    if not (folder / "fit/result.json").exists():
        return case
    case["truth"] = truth = json.loads((folder / "film/truth.json").read_text())
    result = json.loads((folder / "fit/result.json").read_text())
    if f"laws = {json.dumps(LAWS)}" not in result["film"]["settings"]:
        raise ValueError(f"{folder}: not every law was asked for")
    case["evidence"] = {model_named(one["name"]): one["log_evidence"] for one in result["models"] if "log_evidence" in one}
    found = {one["path"]: one for one in result["parameters"] if one["path"].startswith("material[1].")}
    case["first"] = model_named(result["film"]["model"])
    numbers = numbers_of(truth)
    if case["first"] == true_model(truth):
        case["found"] = [(path, true, found[path]["value"], *(math.inf * sign if end is None else end for end, sign in
                                                              zip(found[path]["interval_95"], (-1, 1))))
                         for path, true in numbers.items()]
    return case


def true_model(truth):
    return truth["law"], 1 + len(truth.get("more_terms", []))


def lead(case):
    """ln evidence of the true law's best model over that of the best other law that was compared; a law that was not
    is a million behind."""
    best = {law: max((value for (own, _), value in case["evidence"].items() if own == law), default=-1e6)
            for law in LAWS}
    own = best.pop(case["truth"]["law"])
    return own - max(best.values())


def line_of(case):
    if not case["first"]:
        return f"{case['seed']}: code {case['code']}: {case['message'][-200:]}"
    law, terms = true_model(case["truth"])
    missed = [f"{path} {value:.3g} [{low:.3g}, {high:.3g}] ({true:.3g})" for path, true, value, low, high in case["found"]
              if not low <= true <= high]
    return (f"{case['seed']}: code {case['code']}, {case['seconds']:.0f} s, {law}, {terms}; first: {case['first'][0]}, "
            f"{case['first'][1]}; ahead by {lead(case):.1f}" + "".join(f"; MISSED {one}" for one in missed))


def table(cases):
    """Lines of Markdown."""
    answered = [case for case in cases if case["first"]]
    lines = [f"{len(cases)} films, {len(answered)} with a result, "
             f"{sum(case['code'] == 0 for case in answered)} with exit code 0", "",
             "Films without a result count as wrong, and have no lead.", "",
             "| law | right law first | right number of terms | both | lead of the law: least, median |",
             "| --- | --- | --- | --- | --- |"]
    for law in LAWS:
        some = [case for case in cases if case["model"][0] == law]
        right = [[first == true for first, true in zip(case["first"] or (None, None), case["model"])] for case in some]
        leads = [lead(case) for case in some if case["first"]]
        if not leads:
            continue
        lines.append(f"| {law} | {sum(one[0] for one in right)} of {len(some)} | {sum(one[1] for one in right)} of "
                     f"{len(some)} | {sum(all(one) for one in right)} of {len(some)} | {min(leads):.1f}, "
                     f"{statistics.median(leads):.1f} |")
    lines += ["", "Where the true model is first:", "",
              "| number | 95 % intervals that hold | median error | largest |", "| --- | --- | --- | --- |"]
    rows = [row for case in answered for row in case["found"]]
    for path in sorted({row[0] for row in rows}):
        some = [row for row in rows if row[0] == path]
        errors = [value / true - 1 for _, true, value, _, _ in some]
        lines.append(f"| {path.split('].', 1)[1]} | {sum(low <= true <= high for _, true, _, low, high in some)} of "
                     f"{len(some)} | {100 * statistics.median(map(abs, errors)):.1f} % | "
                     f"{100 * max(errors, key=abs):+.0f} % |")
    return lines


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m tests.independent.laws", description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder")
    parser.add_argument("--first-seed", type=int, default=901)
    parser.add_argument("--films", type=int, default=24)
    parser.add_argument("--program", type=pathlib.Path, required=True, help="palpate")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--terms", type=int, nargs="+", default=[1, 2], help="numbers of relaxation terms to compare")
    parser.add_argument("--keep", action="store_true", help="keep the frames")
    options = parser.parse_args(arguments)
    if not options.program.is_file():
        sys.exit(f"{options.program}: no such program")
    options.out.mkdir(parents=True, exist_ok=True)
    cases = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for case in pool.map(lambda seed: study_film(options, seed),
                             range(options.first_seed, options.first_seed + options.films)):
            print(line_of(case), flush=True)
            cases.append(case)
    text = "\n".join(table(cases))
    (options.out / "table.md").write_text(text + "\n")
    print(text)


if __name__ == "__main__":
    main()
