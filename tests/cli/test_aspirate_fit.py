# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate aspirate fit: tissue from profiles and suction, and what is refused."""
import json
import math

import pytest

from tests import sucked_profiles
from tests.conftest import run_palpate

SETTINGS = """[instrument]
hole_diameter_mm = 10.0
edge_radius_mm = 0.2
rim_thickness_mm = 0.5
outer_diameter_mm = 20.0
pixel_r_um = 62.9
pixel_z_um = 31.75
[pressure]
delay_s = {value = 0.0, sd = 0.02}
[tissue]
depth_mm = 20
steps = 12
"""


@pytest.fixture(scope="module")
def sucked(tmp_path_factory):
    folder = sucked_profiles.make(tmp_path_factory.mktemp("sucked"), 0.15)
    (folder / "aspiration.toml").write_text(SETTINGS)
    return folder


def fit(folder, out, *more, profiles=None, settings=None):
    return run_palpate("aspirate", "fit", profiles or folder / "profiles.csv", "--pressure", folder / "pressure.csv",
                       "--config", settings or folder / "aspiration.toml", "--out", out, "--quiet", *more)


@pytest.fixture(scope="module")
def fitted(sucked, tmp_path_factory):
    out = tmp_path_factory.mktemp("fitted") / "fit"
    finished = fit(sucked, out)
    assert finished.returncode == 0, finished.stderr
    print(finished.stdout)
    return out


def test_tissue_comes_back_with_intervals(fitted, tmp_path):
    result = json.loads((fitted / "result.json").read_text())
    values = {one["path"].split(".")[-1]: one for one in result["parameters"]}
    for name, true, part in (("mu_kpa", 0.7, 0.1), ("gamma", 10, 0.1), ("amplitude", 0.4, 0.15), ("time_s", 3, 0.25)):
        assert values[name]["value"] == pytest.approx(true, rel=part), name
        low, high = values[name]["interval_95"]
        assert low < values[name]["value"] < high
    assert values["delay_s"]["is_nuisance"]
    assert result["distrust"] == ""
    assert result["tissue"]["young_modulus_kpa"]["value"] == pytest.approx(6 * values["mu_kpa"]["value"])
    assert result["tissue"]["young_modulus_kpa"]["interval"] == pytest.approx(
        [6 * end for end in values["mu_kpa"]["interval_95"]])
    assert result["tissue"]["gamma"]["verdict"] == values["gamma"]["verdict"]
    assert result["film"]["travel_mm"] > 0.5
    assert result["version"] and result["film"]["settings"] == SETTINGS
    assert [values[name]["number"] for name in ("mu_kpa", "gamma", "amplitude", "time_s", "r_offset_mm")] == [
        "mu", "gamma", "C", "tau", "axis off its column"]
    assert result["models"][0]["weight"] == pytest.approx(1)
    page = (fitted / "report.html").read_text()
    assert "Over the cycle" in page and "class='map'" in page
    # the model with these values is one that `simulate` runs, and the problem one for `identify`
    finished = run_palpate("simulate", fitted / "identified.toml", "--out", tmp_path / "again", "--quiet")
    assert finished.returncode == 0, finished.stderr


ALL_LAWS = 'laws = ["veronda-westmann", "neo-hookean-reduced", "reduced-polynomial"]\n'


def models_of(out):
    return {one["name"]: one for one in json.loads((out / "result.json").read_text())["models"]}


def test_the_law_of_the_tissue_comes_first_and_is_what_it_is_alone(sucked, fitted, tmp_path):
    settings = tmp_path / "aspiration.toml"
    settings.write_text(SETTINGS + ALL_LAWS + "relaxation_terms = [1, 2]\n")
    out = tmp_path / "fit"
    finished = fit(sucked, out, settings=settings)
    assert finished.returncode == 0, finished.stderr
    result, alone = (json.loads((one / "result.json").read_text()) for one in (out, fitted))
    assert result["film"]["model"] == "veronda-westmann, 1 relaxation term" and result["search"]["mesh_checked"]
    for one, other in zip(result["parameters"], alone["parameters"]):
        assert one["path"] == other["path"]
        sd = math.hypot(other["sd_on_scale"], other["mesh_shift_sd"], 0.01)
        scale = math.log if other["scale"] == "log" else float
        assert abs(scale(one["value"]) - scale(other["value"])) < 0.15 * sd, one["path"]
        if one["is_nuisance"]:
            continue
        assert one["verdict"] == other["verdict"]
        widths = [tissue["interval_95"][1] / tissue["interval_95"][0] for tissue in (one, other)]
        assert math.log(widths[0]) == pytest.approx(math.log(widths[1]), rel=0.05), one["path"]
    models = models_of(out)
    assert len(models) == 6
    first = models["veronda-westmann, 1 relaxation term"]
    assert first["search"] == "to its end" and first["converged"] and first["distrust"] == ""
    assert first["log_evidence"] == pytest.approx(alone["models"][0]["log_evidence"], abs=0.3)
    # a second term that is not there changes little
    assert models["veronda-westmann, 2 relaxation terms"]["log_evidence"] == pytest.approx(first["log_evidence"], abs=4)
    # a law that does not stiffen is given up, and is not tried with more terms
    assert models["neo-hookean-reduced, 1 relaxation term"]["log_evidence"] < first["log_evidence"] - 100
    assert "far behind" in models["neo-hookean-reduced, 1 relaxation term"]["search"]
    assert "log_evidence" not in models["neo-hookean-reduced, 2 relaxation terms"]
    assert models["reduced-polynomial, 1 relaxation term"]["log_evidence"] < first["log_evidence"] - 3
    assert sum(one.get("weight", 0) for one in models.values()) == pytest.approx(1)
    assert all(name in finished.stdout and name in (out / "report.html").read_text() for name in models)


def test_two_relaxation_terms_are_found_where_there_are_two(tmp_path):
    folder = sucked_profiles.make(tmp_path, 0.15, terms=((1.0, 0.25), (0.8, 5)))
    settings = tmp_path / "aspiration.toml"
    settings.write_text(SETTINGS + "relaxation_terms = [2, 1]\n")
    finished = fit(folder, tmp_path / "fit", settings=settings)
    assert finished.returncode == 0, finished.stderr
    result = json.loads((tmp_path / "fit/result.json").read_text())
    assert result["film"]["model"] == "veronda-westmann, 2 relaxation terms"
    one, two = (models_of(tmp_path / "fit")[name] for name in ("veronda-westmann, 1 relaxation term", result["film"]["model"]))
    assert two["log_evidence"] > one["log_evidence"] + 20 and two["search"] == "to its end"
    found = {one["number"]: one for one in result["parameters"]}
    for name, true in (("C", 1.0), ("tau", 0.25), ("C of term 2", 0.8), ("tau of term 2", 5)):
        low, high = found[name]["interval_95"]
        assert low < true < high < 2.5 * low, name
    of_two = ", ".join(f"{name} {found[name + ' of term 2']['value']:.3g}" for name in ("C", "tau"))
    assert f"; term 2: {of_two} s</h1>" in (tmp_path / "fit/report.html").read_text()

    # asked for alone they are what they are beside one
    settings.write_text(SETTINGS + "relaxation_terms = [2]\n")
    finished = fit(folder, tmp_path / "alone", settings=settings)
    assert finished.returncode == 0, finished.stderr
    alone = json.loads((tmp_path / "alone/result.json").read_text())
    assert alone["search"]["log_evidence"] == pytest.approx(result["search"]["log_evidence"], abs=0.5)
    for one in alone["parameters"]:
        beside = found[one["number"]]
        assert one["value"] == pytest.approx(beside["value"], abs=0.1 * (beside["interval_95"][1] - beside["interval_95"][0]))


def test_halves_are_told_on_the_coarse_other_ones_as_well(fitted, tmp_path):
    """`identify` halves cells with the steps of the fit, and steps with its cells; here each with the other doubled."""
    finished = run_palpate("identify", fitted / "experiment.toml", "--out", tmp_path / "other", "--quiet")
    assert finished.returncode == 0, finished.stderr
    ours, others = (json.loads((out / "result.json").read_text()) for out in (fitted, tmp_path / "other"))
    assert ours["search"]["mesh_checked"] and others["search"]["mesh_checked"]
    told = "each with the other of twice the size"  # where that cannot be solved identify's halves stand for it
    assert told in ours["search"]["mesh_check"] and told not in others["search"]["mesh_check"]
    for one, other in zip(ours["parameters"], others["parameters"]):
        if one["is_nuisance"]:
            continue
        claimed = math.hypot(one["mesh_shift_sd"], other["mesh_shift_sd"])  # of logarithms
        assert abs(math.log(one["value"] / other["value"])) < 2 * claimed < 0.15, one["path"]
        assert one["mesh_shift_on_scale"] == pytest.approx(other["mesh_shift_on_scale"], abs=0.015), one["path"]


def test_a_model_of_another_film_is_not_to_be_trusted(sucked, tmp_path):
    """Where tissue bounces, which no law and no tube does, there are no verdicts, and code 7."""
    rows = [line.split(",") for line in (sucked / "profiles.csv").read_text().splitlines()]
    for row in rows[1:]:
        if row[4] == "0":
            row[2] = f"{float(row[2]) + 0.6 * abs((float(row[0]) % 2) - 1) * (1 - abs(float(row[1])) / 5):.5f}"
    profiles = tmp_path / "profiles.csv"
    profiles.write_text("".join(",".join(row) + "\n" for row in rows))
    finished = fit(sucked, tmp_path / "fit", profiles=profiles)
    assert finished.returncode == 7, finished.stdout + finished.stderr
    assert "do not trust the values" in finished.stdout
    result = json.loads((tmp_path / "fit/result.json").read_text())
    assert not result["search"]["mesh_checked"]  # nor is anything else looked for that nobody would believe
    assert "do not trust" in result["distrust"] and result["models"][0]["distrust"] == result["distrust"]
    assert {one["verdict"] for one in result["parameters"] if not one["is_nuisance"]} == {"not judged"}
    assert result["tissue"]["young_modulus_kpa"]["verdict"] == "not judged"
    page = (tmp_path / "fit/report.html").read_text()
    assert "notice bad" in page and "No values to trust" in page


def test_cells_that_cannot_be_doubled_begin_at_the_guess(sucked, tmp_path):
    """A third of two cells is no line of thirds of each: there are no coarse cells to begin with."""
    settings = sucked / "thirds.toml"
    settings.write_text(SETTINGS.replace("steps = 12", "steps = 12\nrefine = 3"))
    finished = fit(sucked, tmp_path / "out", "--time-limit", "2", settings=settings)
    assert finished.returncode == 9, finished.stderr
    assert not (tmp_path / "out").exists()


def test_a_plan_needs_no_film_and_tells_what_to_expect(tmp_path):
    supposed = SETTINGS + "relaxation_terms = [0, 1]\n" + '[frames]\ntimes = "nowhere.csv"\n' + "[supposed]\nmu_kpa = 0.7\ngamma = 10\namplitude = 0.4\ntime_s = 3\n"
    (tmp_path / "plan.toml").write_text(supposed)
    (tmp_path / "pressure.csv").write_text("time_s,suction_mbar\n0,0\n0.2,0\n3.7,60\n6.7,60\n9.7,0\n12,0\n")
    finished = run_palpate("aspirate", "plan", "--pressure", tmp_path / "pressure.csv", "--config", tmp_path / "plan.toml",
                           "--out", tmp_path / "out", "--quiet")
    assert finished.returncode == 0, finished.stderr
    planned = {one["path"].split(".")[-1]: one for one in json.loads((tmp_path / "out/result.json").read_text())["parameters"]}
    assert planned["amplitude"]["interval_95"][0] < 0.4 < planned["amplitude"]["interval_95"][1]  # of one term
    mu = planned["mu_kpa"]
    assert mu["value"] == pytest.approx(0.7, rel=1e-3)
    # what fits add for what no residual shows (2 %, one sd) is in it
    assert 0.078 < mu["interval_95"][1] / mu["interval_95"][0] - 1 < 0.25


def test_a_plan_of_tissue_that_does_not_stiffen_supposes_what_is_told(tmp_path):
    supposed = SETTINGS + 'laws = ["neo-hookean-reduced"]\n[supposed]\nmu_kpa = 4\ngamma = 10\namplitude = 0.4\ntime_s = 3\n'
    (tmp_path / "plan.toml").write_text(supposed)
    (tmp_path / "pressure.csv").write_text("time_s,suction_mbar\n0,0\n0.2,0\n3.7,60\n6.7,60\n9.7,0\n12,0\n")
    finished = run_palpate("aspirate", "plan", "--pressure", tmp_path / "pressure.csv", "--config", tmp_path / "plan.toml",
                           "--out", tmp_path / "out", "--quiet")
    assert finished.returncode == 0, finished.stderr
    mu = json.loads((tmp_path / "out/result.json").read_text())["parameters"][0]
    assert mu["path"].endswith("mu_kpa") and mu["value"] == pytest.approx(4, rel=1e-3)


def test_the_outer_side_slides_is_held_or_is_free(tmp_path):
    (tmp_path / "pressure.csv").write_text("time_s,suction_mbar\n0,0\n0.2,0\n3.7,60\n6.7,60\n9.7,0\n12,0\n")
    sections = {}
    for side in ("slides", "held", "free"):
        settings = SETTINGS.replace("[tissue]\n", f'[tissue]\nside = "{side}"\n')
        assert settings != SETTINGS
        (tmp_path / "plan.toml").write_text(settings + "[supposed]\nmu_kpa = 0.7\ngamma = 10\namplitude = 0.4\ntime_s = 3\n")
        out = tmp_path / side
        finished = run_palpate("aspirate", "plan", "--pressure", tmp_path / "pressure.csv", "--config", tmp_path / "plan.toml",
                               "--out", out, "--quiet")
        assert finished.returncode == 0, finished.stderr
        model = (out / "experiment.toml").read_text()
        sections[side] = model[model.index("[[fix]]"):model.index("[[obstacle]]")]
        assert json.loads((out / "result.json").read_text())["parameters"]
    assert 'components = "x"' in sections["slides"] and "x-max" in sections["held"] and "x-max" not in sections["free"]
    assert "components" not in sections["held"]


def test_a_plan_without_what_it_needs_is_refused(tmp_path):
    (tmp_path / "plan.toml").write_text(SETTINGS)
    (tmp_path / "pressure.csv").write_text("time_s,suction_mbar\n0,0\n1,20\n2,0\n")
    more = ["--pressure", tmp_path / "pressure.csv", "--config", tmp_path / "plan.toml", "--out", tmp_path / "out"]
    finished = run_palpate("aspirate", "plan", *more)
    assert finished.returncode == 2 and "[supposed]" in finished.stderr
    finished = run_palpate("aspirate", "plan", tmp_path / "frames", *more)
    assert finished.returncode == 2 and "takes no frames" in finished.stderr
    finished = run_palpate("aspirate", "fit", *more)
    assert finished.returncode == 2 and "needs frames" in finished.stderr
    assert not (tmp_path / "out").exists()


def changed(path, old, new):
    text = path.read_text()
    assert old in text
    return text.replace(old, new)


@pytest.mark.parametrize("old, new, code, words", [
    ("steps = 12", 'laws = ["rubber"]', 2, "laws"),
    ("steps = 12", "step = 12", 2, "step"),
    ("steps = 12", "relaxation_terms = [4]", 2, "relaxation_terms"),
    ("steps = 12", "relaxation_terms = [1, 0, 1]", 2, "1 stands there twice"),
    ("steps = 12", 'laws = ["veronda-westmann", "veronda-westmann"]', 2, "a law stands there twice"),
    ("edge_radius_mm = 0.2\n", "", 2, "edge_radius_mm"),
    ("delay_s = {value = 0.0, sd = 0.02}", 'delay_s = "unknown"', 2, "delay_s"),
    ("steps = 12", "friction = -1", 2, "friction"),
    ("steps = 12", "refine = 0", 2, "refine"),
    ("steps = 12", 'side = "glued"', 2, "side"),
    ("edge_radius_mm = 0.2\nrim_thickness_mm = 0.5\nouter_diameter_mm = 20.0\n",
     "edge_radius_mm = 8.2\nrim_thickness_mm = 0.5\n", 2, "'outer_diameter_mm' is left out"),
])
def test_settings_are_read_strictly(old, new, code, words, sucked, tmp_path):
    settings = tmp_path / "aspiration.toml"
    settings.write_text(changed(sucked / "aspiration.toml", old, new))
    finished = fit(sucked, tmp_path / "fit", settings=settings)
    assert finished.returncode == code, finished.stderr
    assert words in finished.stderr
    assert not (tmp_path / "fit").exists()


@pytest.mark.parametrize("text, code, words", [
    ("time_s,suction_mbar\n0,0\n1,-20\n2,0\n", 4, "positive"),
    ("time_s,suction_mbar\n0,0\n1,2000\n2,0\n", 4, "1000"),
    ("time_s,suction_mbar\n0,0\n2,20\n1,0\n", 4, "ascend"),
    ("time_s,suction_mbar\n0,0\n1,0\n2,0\n", 4, "no suction"),
    ("time_s,suction_mbar\n0,20\n1,20\n2,0\n", 4, "first reading"),
    ("time_s,suction_mbar\n100,0\n101,20\n102,0\n", 4, "do not overlap"),
    ("time_s,suction_psi\n0,0\n1,1\n", 3, "'suction_mbar' or 'suction_kpa'"),
    ("time_s,suction_kpa\n0,0\n1,143\n2,0\n", 4, "143 kPa"),
    ("time_s,suction_mbar\n0,zero\n", 3, "not a number"),
])
def test_bad_suction_gets_its_code(text, code, words, sucked, tmp_path):
    (tmp_path / "pressure.csv").write_text(text)
    finished = run_palpate("aspirate", "fit", sucked / "profiles.csv", "--pressure", tmp_path / "pressure.csv",
                           "--config", sucked / "aspiration.toml", "--out", tmp_path / "fit", "--quiet")
    assert finished.returncode == code, finished.stderr
    assert words in finished.stderr
    assert not (tmp_path / "fit").exists()


def test_bad_profiles_get_their_code(sucked, tmp_path):
    lines = (sucked / "profiles.csv").read_text().splitlines()
    askew = ["{},{},{:.4f},{},{}".format(*line.split(",")[:2], float(line.split(",")[2]) + 0.15 * float(line.split(",")[1]),
                                         *line.split(",")[3:]) for line in lines[1:]]
    cases = [
        (lines[:1] + lines[2000:3000] + lines[1:1000], 4, "go back"),
        (lines[:500] + ["0.4,0.1,0.9,0,0"], 4, "greater than 0"),
        (lines[:500] + ["9.0,0.1,0.9,0.01,7"], 3, "flag"),
        ([lines[0].replace("z_mm", "height")] + lines[1:], 3, "z_mm"),
        (lines[:1] + askew, 4, "sides differ"),
        (lines[:1] + [line for line in lines[1:] if float(line.split(",")[0]) < 0.2], 4, "do not overlap"),
    ]
    for k, (table, code, words) in enumerate(cases):
        path = tmp_path / f"{k}.csv"
        path.write_text("\n".join(table) + "\n")
        finished = fit(sucked, tmp_path / "fit", profiles=path)
        assert finished.returncode == code, (words, finished.stderr)
        assert words in finished.stderr
        assert not (tmp_path / "fit").exists()
