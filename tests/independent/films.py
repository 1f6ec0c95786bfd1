# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Films of sucked tissue whose truth, solver and renderer are not palpate's, and how well palpate finds that tissue.

    python -m tests.independent.films make --seed 401 --out DIR [--kind NAME] [--side held]
    python -m tests.independent.films study --first-seed 401 --films 40 --out DIR --program PATH [--kind NAME]
        [--side held] [--jobs 1]

`make` writes DIR/frames/*.pgm, pressure.csv, aspiration.toml, truth.json and profiles_true.csv. `study` makes films,
runs `palpate aspirate run` on each and prints tables; films that are done are not run again, and those that give no
answer are counted. KINDS are those of silhouettes.py ("noise 3" is the default). A seed has the same truth whatever
the kind is.
--side says whether the tissue's outer side is held or slides up and down; its bottom is held. Nobody tells palpate.

The outline is that of sucked_tissue.py, the picture of silhouettes.py: columns and rows count from 0 at the middle of
the first pixel, and z = 0 is at row 150. What is told of edge radius, both sizes of a pixel and the delay is wrong by
draws of the sd that is told with it (an edge outside of 0.1 to 0.35 mm is drawn again); hole, width, depth and suction
are right.
"""
import argparse
import collections
import concurrent.futures
import dataclasses
import importlib.util
import json
import math
import pathlib
import shutil
import statistics
import subprocess
import sys
import time

import numpy as np

from . import silhouettes
from .sucked_tissue import Law, NoEquilibrium, Section, State, Tube, advance, heights, run

HOLE_MM, OUTER_MM, RIM_MM, RATE_HZ, BASE_ROW = 10.0, 20.0, 0.5, 25.0, 150
TOLD_R_UM, TOLD_Z_UM, SCALE_SD, EDGE_SD_MM, DELAY_SD_S = 62.9, 31.75, 0.005, 0.05, 0.02
READINGS_S = 0.02
KINDS = {kind.name: kind for kind in silhouettes.SUITE}
NUMBERS = {"mu_kpa": "mu", "gamma": "gamma", "amplitude": "C", "time_s": "tau"}


# ---- what is drawn

def drawn_until(draw, low, high):
    while True:
        value = float(draw())
        if low <= value <= high:
            return value


def draw_history(random):
    """Kind, times (multiples of 0.02 s) and parts of the peak between which suction is linear, the film's length."""
    kind = ["linear", "smooth", "stairs", "slow release"][random.integers(4)]
    start = random.uniform(0.3, 0.6)
    if kind == "linear":
        lengths, parts = [random.uniform(1.5, 4), random.uniform(2, 4), random.uniform(1, 2.5)], [1, 1, 0]
    elif kind == "smooth":
        lengths, parts = [random.uniform(2, 4.5), random.uniform(1, 3), random.uniform(1.5, 3)], [1, 1, 0]
    elif kind == "stairs":
        lengths = [random.uniform(0.7, 1.5), random.uniform(1.2, 2.2), random.uniform(0.7, 1.5),
                   random.uniform(1.2, 2.5), random.uniform(1, 2)]
        stair = random.uniform(0.4, 0.65)
        parts = [stair, stair, 1, 1, 0]
    else:
        lengths, parts = [random.uniform(1.2, 3), random.uniform(0.8, 2), random.uniform(4, 6)], [1, 1, 0]
    kinks = np.round(np.cumsum([start, *lengths]) / READINGS_S) * READINGS_S
    end = float(np.clip(kinks[-1] + random.uniform(1.0, 4.5), 10, 15))
    return kind, np.array([0, *kinks]), np.array([0, 0, *parts], float), end


def suction_parts(kind, kinks, parts, times):
    """Parts of the peak at times: linear between kinks, or, of "smooth", halves of a cosine."""
    if kind != "smooth":
        return np.interp(times, kinks, parts)
    at = np.clip(np.searchsorted(kinks, times, side="right") - 1, 0, len(kinks) - 2)
    along = np.clip((times - kinks[at]) / (kinks[at + 1] - kinks[at]), 0, 1)
    return parts[at] + (parts[at + 1] - parts[at]) * 0.5 * (1 - np.cos(np.pi * along))


def cap_of(truth):
    """Height over x in [0, 1] as a part of the cap's: an arc of a circle with a bump, or 1 - x^n."""
    if truth["cap_kind"] == "power":
        return lambda x: 1 - np.abs(x) ** truth["cap_power"]
    steep, bump, place, wide = truth["cap_arc"], truth["cap_bump"], truth["cap_bump_at"], truth["cap_bump_wide"]

    def cap(x):
        low = math.sqrt(1 - steep**2)
        arc = (np.sqrt(1 - (steep * x) ** 2) - low) / (1 - low)
        swell = np.exp(-0.5 * ((x - place) / wide) ** 2) + np.exp(-0.5 * ((x + place) / wide) ** 2)
        base = 2 * math.exp(-0.5 * (place / wide) ** 2)
        return arc + bump * (1 - x * x) * (swell - base)
    return cap


def draw_truth(seed):
    """All of a film but its peak of suction, which asks for the mechanics."""
    random = np.random.default_rng([5113, seed])
    truth = {"format": "independent-aspiration-truth", "seed": seed, "law": "veronda-westmann",
             "mu_kpa": drawn_until(lambda: 0.8 * math.exp(0.6 * random.standard_normal()), 0.2, 5),
             "gamma": drawn_until(lambda: random.normal(10, 4), 2, 22),
             "amplitude": 0.15 + 0.75 * random.beta(2, 2.5),
             "time_s": drawn_until(lambda: 2.5 * math.exp(0.5 * random.standard_normal()), 0.5, 8),
             "cap_mm": random.uniform(0.8, 1.3), "cap_kind": ["arc with bump", "power"][random.integers(2)],
             "cap_power": random.uniform(1.9, 2.6), "cap_arc": random.uniform(0.3, 0.7),
             "cap_bump": random.uniform(-0.08, 0.08), "cap_bump_at": random.uniform(0, 0.5),
             "cap_bump_wide": random.uniform(0.25, 0.4),
             "width_mm": round(random.uniform(20, 25), 1), "depth_mm": round(random.uniform(16, 20), 1),
             "told_edge_radius_mm": round(random.uniform(0.19, 0.25), 3)}
    truth["edge_radius_mm"] = drawn_until(
        lambda: truth["told_edge_radius_mm"] + EDGE_SD_MM * random.standard_normal(), 0.1, 0.35)
    truth["pixel_r_um"] = TOLD_R_UM * (1 + SCALE_SD * random.standard_normal())
    truth["pixel_z_um"] = TOLD_Z_UM * (1 + SCALE_SD * random.standard_normal())
    truth["delay_s"] = DELAY_SD_S * random.standard_normal()
    truth["axis_column_px"] = 89.5 + random.uniform(-2, 2)
    kind, kinks, parts, end = draw_history(random)
    truth |= {"history": kind, "kinks_s": kinks.tolist(), "parts": parts.tolist(), "end_s": end,
              "wanted_travel_mm": random.uniform(0.75, 1.5)}
    return truth


# ---- what follows from it

def section_of(truth, coarse):
    return Section(truth["cap_mm"], cap_of(truth), truth["width_mm"], truth["depth_mm"], coarse, truth["side"])


def tube_of(truth, stiffness):
    return Tube(HOLE_MM / 2, truth["edge_radius_mm"], OUTER_MM / 2, stiffness)


def law_of(truth, kappa):
    more = tuple((one["amplitude"], one["time_s"]) for one in truth.get("more_terms", []))
    return Law(truth["mu_kpa"], truth["gamma"], kappa, truth["amplitude"], truth["time_s"], more, truth["law"])


def peak_for(truth):
    """The peak of suction (kPa) that lifts the apex by about what is wanted: elastic states on a coarse mesh, and the
    elastic pressure p of a viscous one P by p + sum of amplitude int exp(-(t - s)/time) dp/ds ds = P."""
    times = np.arange(0, truth["end_s"], 0.01)
    parts = suction_parts(truth["history"], np.array(truth["kinks_s"]), np.array(truth["parts"]), times)
    amplitude, time = law_of(truth, 1.0).terms()
    elastic, memory, most = 0.0, np.zeros(len(time)), 0.0
    fade = np.exp(-0.01 / time)
    for part in parts:
        new = (part - np.sum(fade * memory - amplitude * elastic)) / (1 + amplitude.sum())
        memory = fade * memory + amplitude * (new - elastic)
        elastic, most = new, max(most, new)
    mu = truth["mu_kpa"]
    body = section_of(truth, 3.0).body(tube_of(truth, 3e4 * mu))
    law = dataclasses.replace(law_of(truth, 3000 * mu), amplitude=0.0, more_terms=())
    before, state, kpa, rise = None, State(body), 0.0, [(0.0, 0.0)]
    while rise[-1][0] < truth["wanted_travel_mm"]:
        kpa = kpa * 1.25 + 0.1 * mu
        before, state = state, advance(body, law, state, state.time + 1.0, kpa, before)
        rise.append((float(state.u[body.surface[0], 1]), kpa))
    return float(np.interp(truth["wanted_travel_mm"], *np.array(rise).T)) / most


def solved(truth, coarse=1.5, parts=1, stiffer=1.0):
    """Times of the frames, surfaces [frames, nodes, 2] that they show, in steps from frame to frame (each in `parts`)
    that also end at kinks, and what is told of the run."""
    peak = truth["peak_suction_kpa"]
    stamps = np.arange(int(truth["end_s"] * RATE_HZ) + 1) / RATE_HZ
    shown = np.maximum(stamps - truth["delay_s"], 0.0)
    ends = np.unique(np.round(np.concatenate([[0.0], shown, truth["kinks_s"]]), 9))
    ends = ends[(ends <= shown[-1] + 1e-9)]
    ends = ends[np.concatenate([[True], np.diff(ends) > 1e-4])]
    fine = [ends[:-1] + (ends[1:] - ends[:-1]) * k / parts for k in range(parts)]
    fine = np.unique(np.concatenate([*fine, ends[-1:]]))
    body = section_of(truth, coarse).body(tube_of(truth, stiffer * (3e4 * truth["mu_kpa"] + 2e4 * peak)))
    kappa = 1000 * max(6 * truth["mu_kpa"], peak)
    law = law_of(truth, kappa)
    inside = np.einsum("eai->ei", body.nodes[body.cells])[:, 0] / 9 < HOLE_MM / 2 - 0.5
    seen = {"largest_stretch": 1.0, "deepest_mm": 0.0, "largest_volume_change": 0.0}

    def watch(state):
        f, ft, c = body.strains(state.u)
        plane = 0.5 * (c[..., 0] + c[..., 1]) + np.hypot(0.5 * (c[..., 0] - c[..., 1]), c[..., 2])
        stretch = math.sqrt(max(plane[inside].max(), c[inside][..., 3].max()))
        volume = np.abs((f[..., 0, 0] * f[..., 1, 1] - f[..., 0, 1] * f[..., 1, 0]) * ft - 1)[inside].max()
        for key, value in zip(seen, (stretch, body.contact(state.u)[2], volume)):
            seen[key] = max(seen[key], float(value))
    kinks, levels = np.array(truth["kinks_s"]), np.array(truth["parts"])
    kpa = peak * suction_parts(truth["history"], kinks, levels, fine)
    surfaces, _ = run(body, law, fine, kpa, watch)
    at = np.argmin(np.abs(fine[None] - shown[:, None]), axis=1)
    return stamps, surfaces[at], seen | {"steps": len(fine) - 1, "cells": len(body.cells)}


def nominal_kpa(mu, gamma, stretch, law="veronda-westmann"):
    """Uniaxial, incompressible, after an endless time: dW/dl = 2 psi'(l^2 + 2/l - 3) (l - l^-2)."""
    first, _ = Law(mu, gamma, 0.0, name=law).slopes(stretch**2 + 2 / stretch - 3)
    return 2 * float(first) * (stretch - stretch**-2)


# ---- pictures and files

def rendered(kind, seed, edges, apexes_mm):
    """Frames of silhouettes.film with outlines of our own: edges [frames, 3 x columns] are rows at its fine columns."""
    spec = importlib.util.find_spec(silhouettes.__name__)  # a copy of the module, so that no one else sees the change
    scene = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(scene)
    side, fine = scene.SIDE, scene.FINE
    columns = (np.arange(fine * side) + 0.5) / fine - 0.5
    frame_of = {}
    for k, apex in enumerate(apexes_mm):  # film() knows its frames by the apex alone
        other = frame_of.setdefault(float(apex), k)
        assert np.abs(edges[other] - edges[k]).max() < 1e-3
    scene.heights_mm = lambda num_frames: apexes_mm
    scene.edge_row = lambda column, apex, lean: np.interp(column, columns, edges[frame_of[float(apex)]])
    for frame, _ in scene.film(kind, seed, len(apexes_mm)):
        yield frame


def make(seed, out, kind="noise 3", side="held", tissue=None):
    """Writes a film; its truth. `tissue` says what of it is not drawn."""
    began = time.monotonic()
    truth = draw_truth(seed) | {"side": side} | (tissue or {})
    truth["peak_suction_kpa"] = peak_for(truth)
    stamps, surfaces, told = solved(truth)
    apexes = surfaces[:, 0, 1]
    truth |= {"kind": kind, "travel_mm": float(apexes.max() - apexes[0]), "frames": len(stamps), "solver": told,
              "largest_stretch": told.pop("largest_stretch"), "seconds_solving": time.monotonic() - began}
    truth["stress_at_largest_stretch_kpa"] = nominal_kpa(truth["mu_kpa"], truth["gamma"], truth["largest_stretch"],
                                                         truth["law"])

    shutil.rmtree(out / "frames", ignore_errors=True)  # of an earlier, perhaps longer film
    (out / "frames").mkdir(parents=True)
    fine = silhouettes.FINE
    columns = (np.arange(fine * silhouettes.SIDE) + 0.5) / fine - 0.5
    r = (columns - truth["axis_column_px"]) * truth["pixel_r_um"] / 1000
    z = np.nan_to_num(heights(surfaces, np.abs(r)), nan=0.0)
    z[:, np.abs(r) >= HOLE_MM / 2 + truth["edge_radius_mm"]] = 0.0
    edges = BASE_ROW - z / (truth["pixel_z_um"] / 1000)
    for k, frame in enumerate(rendered(KINDS[kind], seed, edges, apexes)):
        (out / f"frames/frame{k:05d}.pgm").write_bytes(b"P5\n%d %d\n255\n" % frame.shape[::-1] + frame.tobytes())

    readings = np.arange(int(truth["end_s"] / READINGS_S) + 2) * READINGS_S
    kpa = truth["peak_suction_kpa"] * suction_parts(truth["history"], np.array(truth["kinks_s"]),
                                                    np.array(truth["parts"]), readings)
    write_rows(out / "pressure.csv", "time_s,suction_kpa", [f"{t:.3f},{p:.6f}" for t, p in zip(readings, kpa)])
    middle = slice(1, None, fine)  # of the fine columns, those at the middle of a pixel
    rows = [f"{t:.4f},{x:.5f}," + (f"{h:.6f},0.003,0" if h > RIM_MM else f"{RIM_MM / 2:.6f},0.144,2")
            for t, line in zip(stamps, z[:, middle]) for x, h in zip(r[middle], line) if abs(x) < HOLE_MM / 2]
    write_rows(out / "profiles_true.csv", "time_s,r_mm,z_mm,sd_mm,flag", rows)
    (out / "aspiration.toml").write_text(f"""# Made by: python -m tests.independent.films make --seed {seed}
[instrument]
hole_diameter_mm = {HOLE_MM}
edge_radius_mm = {{value = {truth["told_edge_radius_mm"]}, sd = {EDGE_SD_MM}}}
rim_thickness_mm = {RIM_MM}
outer_diameter_mm = {OUTER_MM}
pixel_r_um = {{value = {TOLD_R_UM}, sd = {TOLD_R_UM * SCALE_SD:.5f}}}
pixel_z_um = {{value = {TOLD_Z_UM}, sd = {TOLD_Z_UM * SCALE_SD:.5f}}}
base_row_px = {BASE_ROW}
[frames]
rate_hz = {RATE_HZ}
[pressure]
delay_s = {{value = 0.0, sd = {DELAY_SD_S}}}
[tissue]
depth_mm = {truth["depth_mm"]}
width_mm = {truth["width_mm"]}
laws = ["veronda-westmann"]
relaxation_terms = [1]
""")
    truth["seconds"] = time.monotonic() - began
    (out / "truth.json").write_text(json.dumps(truth, indent=2) + "\n")
    return truth


def write_rows(path, head, rows):
    path.write_text("\n".join([head, *rows]) + "\n")


# ---- a study

@dataclasses.dataclass
class Found:
    """Of one number of one film."""
    true: float
    value: float
    low: float
    high: float
    verdict: str

    @property
    def holds(self):
        return self.low <= self.true <= self.high


def film_of(options, seed):
    if not options.films_from:
        return options.out / f"film-{seed}/film"
    folder = options.films_from / f"film-{seed}"
    return folder / "film" if (folder / "film").is_dir() else folder  # of a study that kept its films


def fitted(program, film, settings, out):
    """What `palpate aspirate run` says of a film, {"code", "seconds", "message"}; its result is in `out`."""
    began = time.monotonic()
    finished = subprocess.run([str(program), "aspirate", "run", str(film / "frames"), "--pressure",
                               str(film / "pressure.csv"), "--config", str(settings), "--out", str(out), "--overwrite",
                               "--quiet"], capture_output=True, text=True)
    return {"code": finished.returncode, "seconds": time.monotonic() - began,
            "message": finished.stderr.strip()[-400:]}


def study_film(options, seed):
    """Makes and fits one film unless that is done; what came out."""
    folder = options.out / f"film-{seed}"
    outcome = folder / "outcome.json"
    if not outcome.exists():
        film = film_of(options, seed)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        made, message = 0, ""
        if not ((film / "truth.json").exists() and (film / "frames").is_dir()):
            making = subprocess.run([sys.executable, "-m", "tests.independent.films", "make", "--seed", str(seed),
                                     "--out", str(film), "--kind", options.kind, "--side", options.side],
                                    capture_output=True, text=True)
            made, message = making.returncode, making.stderr.strip()[-400:]
        said = {"seed": seed, "made": made, "code": None, "message": message}
        if made == 0:
            shutil.copy(film / "truth.json", folder / "truth.json")
            said |= fitted(options.program, film, film / "aspiration.toml", folder / "fit")
            if not (options.keep or options.films_from):
                shutil.rmtree(film)
        outcome.write_text(json.dumps(said, indent=2) + "\n")
    return read_film(folder)


def read_film(folder):
    """{"outcome", "truth", "found": {number: Found}} of a folder of a study."""
    case = {"outcome": json.loads((folder / "outcome.json").read_text()), "truth": None, "found": {}}
    if (folder / "truth.json").exists():
        case["truth"] = json.loads((folder / "truth.json").read_text())
    if (folder / "fit/result.json").exists():
        for one in json.loads((folder / "fit/result.json").read_text())["parameters"]:
            name = one["path"].split(".")[-1]
            if name in NUMBERS:
                low, high = (math.inf * sign if end is None else end for end, sign in zip(one["interval_95"], (-1, 1)))
                case["found"][name] = Found(case["truth"][name], one["value"], low, high, one.get("verdict", ""))
    return case


def line_of(case):
    outcome, truth = case["outcome"], case["truth"]
    head = f"{outcome['seed']}: code {outcome['code'] if outcome['made'] == 0 else 'none, no film'}, "
    if truth:
        head += f"{truth['history']}, {truth['cap_kind']}, travel {truth['travel_mm']:.2f}, "
    return head + (", ".join(f"{NUMBERS[name]} {one.value:.3g} [{one.low:.3g}, {one.high:.3g}] ({one.true:.3g}"
                             f"{'' if one.holds else ', MISSED'})" for name, one in case["found"].items()) or
                   outcome["message"][-200:])


def stress_errors(cases):
    return [nominal_kpa(case["found"]["mu_kpa"].value, case["found"]["gamma"].value, case["truth"]["largest_stretch"])
            / case["truth"]["stress_at_largest_stretch_kpa"] - 1 for case in cases]


def table(cases):
    """Lines of Markdown. Films without an answer are in the first line and in no other."""
    codes = collections.Counter("no film" if case["outcome"]["made"] else str(case["outcome"]["code"])
                                for case in cases)
    lines = [f"{len(cases)} films; by exit code: " + ", ".join(f"{code}: {count}"
                                                               for code, count in sorted(codes.items())), ""]
    answers = [case for case in cases if len(case["found"]) == len(NUMBERS)]
    sure = [case for case in answers if case["outcome"]["code"] == 0]
    lines += [f"Of the {len(sure)} films with exit code 0 (in brackets: of all {len(answers)} with a result):", "",
              "| number | 95 % intervals that hold | of those recovered | median error | median signed | largest | "
              "recovered, weak, not identifiable |", "| --- | --- | --- | --- | --- | --- | --- |"]
    for name, short in NUMBERS.items() if sure else ():
        rows, all_rows = ([case["found"][name] for case in some] for some in (sure, answers))
        errors = [row.value / row.true - 1 for row in rows]
        recovered = [row for row in rows if row.verdict == "recovered"]
        verdicts = [sum(row.verdict == word for row in rows)
                    for word in ("recovered", "weak", "not identifiable")]
        lines.append(f"| {short} | {sum(row.holds for row in rows)} of {len(rows)} "
                     f"({sum(row.holds for row in all_rows)} of {len(all_rows)}) | "
                     f"{sum(row.holds for row in recovered)} of {len(recovered)} | "
                     f"{100 * statistics.median(map(abs, errors)):.1f} % | {100 * statistics.median(errors):+.1f} % | "
                     f"{100 * max(errors, key=abs):+.0f} % | {', '.join(map(str, verdicts))} |")
    if sure:
        errors = stress_errors(sure)
        lines.append(f"| stress | | | {100 * statistics.median(map(abs, errors)):.1f} % | "
                     f"{100 * statistics.median(errors):+.1f} % | {100 * max(errors, key=abs):+.0f} % | |")
        lines += ["", "stress: nominal, uniaxial, long-term, at the largest stretch of the truth (more than "
                  "0.5 mm from the hole's edge)."]
    return lines


def study(options):
    if options.films_from and options.films_from.resolve() == options.out.resolve():
        sys.exit("--films-from is the study's own folder: choose another --out")
    options.out.mkdir(parents=True, exist_ok=True)
    version = subprocess.run([str(options.program), "--version"], capture_output=True, text=True).stdout.split("\n")[0]
    said = {"kind": options.kind, "side": options.side, "program": version}
    if options.films_from:
        said["films_from"] = str(options.films_from.resolve())
    settings = options.out / "settings.json"
    if settings.exists() and json.loads(settings.read_text()) != said:
        sys.exit(f"{options.out} holds a study with other settings: choose another folder")
    settings.write_text(json.dumps(said) + "\n")
    seeds, cases = range(options.first_seed, options.first_seed + options.films), []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for case in pool.map(lambda seed: study_film(options, seed), seeds):
            print(line_of(case), flush=True)
            cases.append(case)
    text = "\n".join(table(cases))
    (options.out / "table.md").write_text(text + "\n")
    print(text)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m tests.independent.films", description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    for name in ("make", "study"):
        command = commands.add_parser(name)
        command.add_argument("--out", type=pathlib.Path, required=True, help="folder")
        command.add_argument("--kind", choices=list(KINDS), default="noise 3")
        command.add_argument("--side", choices=["held", "sliding"], default="held", help="the tissue's outer side")
        if name == "make":
            command.add_argument("--seed", type=int, required=True)
        else:
            command.add_argument("--first-seed", type=int, default=401)
            command.add_argument("--films", type=int, default=40)
            command.add_argument("--program", type=pathlib.Path, required=True, help="palpate")
            command.add_argument("--jobs", type=int, default=1)
            command.add_argument("--keep", action="store_true", help="keep the frames")
            command.add_argument("--films-from", type=pathlib.Path, metavar="DIR",
                                 help="films of an earlier study (DIR/film-SEED) are taken as they are, others are made there")
    options = parser.parse_args(arguments)
    if options.command == "study":
        study(options)
        return
    try:
        print(json.dumps(make(options.seed, options.out, options.kind, options.side), indent=2))
    except NoEquilibrium as error:
        sys.exit(f"no equilibrium: {error}")


if __name__ == "__main__":
    main()
