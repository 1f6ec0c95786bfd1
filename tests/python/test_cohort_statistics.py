# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Statistics of a cohort against SciPy and statsmodels, published p values, and simulated cohorts; the report a user gets."""
import itertools
import json
import math
import subprocess
import sys

import numpy as np
import pytest

pd = pytest.importorskip("pandas", reason="pandas is not installed (pip install palpate[cohort])")
pytest.importorskip("statsmodels", reason="statsmodels is not installed (pip install palpate[cohort])")
from scipy import stats  # noqa: E402

from palpate.cohort import statistics as st  # noqa: E402
from palpate.cohort.errors import CohortError  # noqa: E402
from palpate.cohort.tables import read_pairs, read_participants  # noqa: E402

STAGES = [1, 1, 1, 1, 2, 2, 2, 3, 3, 3]
TRUE_KPA = [42, 48, 55, 60, 70, 82, 90, 110, 130, 150]
TARGETS = [8, 16, 9, 12, 17, 15, 6, 6, 7, 16]  # of each patient: 112


def pairs_table(random, sd_reference=0.06, sd_pair=0.07, kpa=TRUE_KPA, targets=TARGETS):
    """pairs.tsv with errors that are known: a share of the reference, one of each pair."""
    rows = []
    for patient, (e, n) in enumerate(zip(kpa, targets), 1):
        shared = random.normal(0, sd_reference)
        for k in range(n):
            ln = math.log(e) + shared + random.normal(0, sd_pair)
            rows.append(dict(participant_id=f"{patient:03}", reference="ref-01", target=f"target-{k + 1:02}", status="done", code="0",
                             verdict="recovered", region="prostate", e_kpa=f"{math.exp(ln):.6g}", ln_e=f"{ln:.6f}", sd_ln=f"{sd_pair}",
                             ln_e_data=f"{ln:.6f}", sd_data=f"{sd_pair}"))
    return pd.DataFrame(rows)


def write(folder, table, name="pairs.tsv"):
    path = folder / name
    table.to_csv(path, sep="\t", index=False)
    return path


def run(*command):
    return subprocess.run([sys.executable, "-m", "palpate.cohort", *map(str, command)], capture_output=True, text=True)


def test_the_same_patient_with_and_without_sub_is_refused(tmp_path):
    path = write(tmp_path, pd.DataFrame({"participant_id": ["01", "sub-02", "sub-01"], "stage": ["1", "2", "3"]}), "people.tsv")
    with pytest.raises(CohortError, match="'01' and 'sub-01' are the same patient"):
        read_participants(path)


def test_pairs_that_a_person_rejected_do_not_enter(tmp_path):
    table = pairs_table(np.random.default_rng(0)).assign(rating="")
    table.loc[3, "rating"] = "reject"
    table.loc[4, "rating"] = "unsure"
    pairs = read_pairs(write(tmp_path, table))
    assert len(pairs.used) == 111 and list(pairs.excluded["reason"]) == ["rejected in the gallery"]


@pytest.mark.parametrize("r, p", [(0.662, 0.0370), (0.701, 0.0239), (0.704, 0.0231), (0.636, 0.0481)])
def test_p_values_that_were_published(r, p):
    assert st.p_of_correlation(r, 10) == pytest.approx(p, abs=6e-5)


def test_correlations_are_those_of_scipy():
    random = np.random.default_rng(1)
    x, y = np.array(STAGES, float), random.normal(size=10) + np.array(STAGES)
    for mine, theirs in ((st.pearson(x, y), stats.pearsonr(x, y)), (st.spearman(x, y), stats.spearmanr(x, y)),
                         (st.kendall(x, y), stats.kendalltau(x, y))):
        assert mine.value == pytest.approx(theirs[0], abs=1e-9)
        assert mine.p == pytest.approx(theirs[1], abs=1e-9)
        assert mine.n == 10


def test_the_permutation_test_counts_every_order_once():
    x, y = np.array([1.0, 1, 2, 2, 3]), np.array([0.3, 1.1, 0.9, 2.0, 1.7])
    orders = set(itertools.permutations(x))
    observed = abs(np.corrcoef(x, y)[0, 1])
    by_hand = np.mean([abs(np.corrcoef(o, y)[0, 1]) >= observed - 1e-12 for o in orders])
    p, count, is_all = st.permutation_p(x, y)
    assert (count, is_all) == (len(orders), True)
    assert p == pytest.approx(by_hand, abs=1e-12)
    assert st.num_arrangements(STAGES) == 4200


def test_stages_that_mean_nothing_are_significant_in_one_of_twenty():
    from palpate.cohort.statistics.association import all_arrangements
    y = stats.rankdata(TRUE_KPA)
    orders = all_arrangements(stats.rankdata(STAGES))
    sizes = np.abs(orders @ (y - y.mean()))
    p = np.array([np.mean(sizes >= size - 1e-9) for size in sizes])  # of every order that chance can make
    assert 0.035 <= np.mean(p < 0.05) <= 0.05
    for k in (0, 77, 4000):
        assert st.permutation_p(orders[k], y)[0] == pytest.approx(p[k], abs=1e-12)


def test_random_effects_are_those_of_statsmodels():
    from statsmodels.stats.meta_analysis import combine_effects
    random = np.random.default_rng(4)
    ln, sd = random.normal(4, 0.2, 9), random.uniform(0.05, 0.3, 9)
    theirs = combine_effects(ln, sd**2, method_re="iterated", use_t=True)
    mine = st.random_effects(ln, sd)
    assert mine.ln == pytest.approx(theirs.mean_effect_re, abs=1e-9)
    low, high = theirs.conf_int()[1][:2]
    assert np.log(mine.interval_kpa()) == pytest.approx([low, high], abs=1e-9)


def test_without_scatter_a_weighted_regression_is_that_of_statsmodels():
    import statsmodels.api as sm
    x = np.array(STAGES, float)
    ln = 4 + 0.3 * x + np.array([0.01, -0.02, 0.015, 0, -0.01, 0.02, -0.015, 0.01, 0, -0.01])
    sd = np.linspace(0.1, 0.3, 10)
    mine, theirs = st.weighted_regression(x, ln, sd), sm.WLS(ln, sm.add_constant(x), weights=sd**-2.0).fit()
    assert mine.scatter == 0
    assert [mine.intercept, mine.slope] == pytest.approx(theirs.params, abs=1e-9)


def test_an_area_under_the_curve_by_counting():
    high, y = np.array([0, 0, 1, 1, 1], bool), np.array([1.0, 3, 2, 3, 5])
    counted = np.mean([(a > b) + 0.5 * (a == b) for a in y[high] for b in y[~high]])
    assert st.discrimination(high, y).auc == pytest.approx(counted)


def coverage(sd_reference, random, draws=1000):
    """Share of patients' intervals that hold: pairs off by 0.09, of which 0.06 is their reference's."""
    held = 0
    for _ in range(draws):
        ln = random.normal(0, 0.06) + random.normal(0, math.sqrt(0.09**2 - 0.06**2), 11)
        low, high = np.log(st.random_effects(ln, np.full(11, 0.067), sd_reference).interval_kpa())
        held += low <= 0 <= high
    return held / draws


def test_a_shared_reference_must_be_in_the_interval():
    assert coverage(0.0, np.random.default_rng(5)) < 0.75
    assert 0.93 <= coverage(0.06, np.random.default_rng(5)) <= 0.97


def test_the_error_of_the_reference_is_found_from_phantoms_and_from_reversed_pairs():
    random = np.random.default_rng(6)
    shared = np.repeat(random.normal(0, 0.06, 40), 8)
    found = st.reference_error_from_truth(np.repeat(np.arange(40), 8), np.zeros(320, int), shared + random.normal(0, 0.05, 320))
    assert found.low <= 0.06 <= found.high and found.high < 0.1
    participant, reference, target, ln = [], [], [], []
    for p in range(12):
        as_reference, as_target = random.normal(0, 0.08, 5), random.normal(0, 0.03, 5)
        for a, b in itertools.permutations(range(5), 2):
            participant.append(p), reference.append(f"i{a}"), target.append(f"i{b}")
            ln.append(4 + 0.1 * p + as_reference[a] + as_target[b] + random.normal(0, 0.04))
    found = st.reference_error_from_images(participant, reference, target, ln)
    assert found.low <= 0.08 <= found.high
    without = st.reference_error_from_images(participant, reference, None, ln)  # targets' share is in the pairs' own
    assert without.low <= 0.08 <= without.high and math.isnan(without.sd_target)
    with pytest.raises(CohortError, match="several references"):
        st.reference_error_from_images(["a"] * 4, ["r"] * 4, list("wxyz"), [1, 2, 3, 4])


def test_scans_of_patients():
    random = np.random.default_rng(7)
    table = pairs_table(random, sd_reference=0, sd_pair=0.08)
    found = st.repeatability(table["participant_id"], table["ln_e"].astype(float))
    assert found.within_sd == pytest.approx(0.08, abs=0.017)  # three of its standard errors
    assert found.within_interval[0] < found.within_sd < found.within_interval[1]
    assert found.icc > 0.9 and (found.num_patients, found.num_pairs) == (10, 112)
    assert found.more_percent == pytest.approx(100 * math.expm1(2.77 * found.within_sd))


def test_ids_are_text_and_what_says_nothing_stays_out(tmp_path):
    table = pairs_table(np.random.default_rng(8), targets=[2, 2, 2, 3, 2, 2, 2, 2, 2, 2])
    table.loc[0, "participant_id"] = table.loc[1, "participant_id"] = "NA"
    table.loc[2, ["verdict", "e_kpa", "ln_e", "sd_ln"]] = ["not identifiable", "", "", ""]
    table.loc[3, "verdict"] = "weak"
    table.loc[4, ["status", "code", "verdict", "region", "e_kpa", "ln_e"]] = ["failed", "5", "no mesh", "", "", ""]
    table.loc[5, "status"] = "stale"
    pairs = read_pairs(write(tmp_path, table))
    assert pairs.total == len(table) and list(pairs.used["participant_id"][:2]) == ["NA", "NA"]
    assert sorted(pairs.excluded["reason"]) == ["failed with code 5", "not identifiable", "of other settings or inputs than planned"]
    patients = st.patient_table(pairs.used)
    assert patients.loc["NA", "pairs"] == 2 and patients.loc["002", "weak"] == 1


@pytest.mark.parametrize("change, sentence", [
    (lambda t: t.drop(columns="ln_e"), "no column 'ln_e'"),
    (lambda t: t.assign(ln_e="soft"), "row 2, column ln_e: 'soft' is no number"),
    (lambda t: t.assign(region=["bladder"] + ["prostate"] * (len(t) - 1)), "choose one with --region"),
])
def test_bad_tables(tmp_path, change, sentence):
    path = write(tmp_path, change(pairs_table(np.random.default_rng(9))))
    with pytest.raises(CohortError, match=sentence):
        read_pairs(path)


def test_a_report_from_the_command_line(tmp_path):
    pairs = write(tmp_path, pairs_table(np.random.default_rng(10)))
    people = tmp_path / "participants.tsv"
    people.write_text("participant_id\tstage\n" + "".join(f"sub-{k:03}\tT{s}\n" for k, s in enumerate(STAGES, 1)))
    done = run("report", pairs, "--participants", people, "--against", "stage", "--sd-reference", "0.06", "--out", tmp_path / "report")
    assert done.returncode == 0, done.stderr
    figures = json.loads((tmp_path / "report" / "statistics.json").read_text())
    assert (figures["pairs_used"], figures["patients"]) == (112, 10)
    spearman = next(c for c in figures["correlations"] if c["test"] == "Spearman")
    assert spearman["n"] == 10 and spearman["arrangements"] == 4200 and abs(spearman["value"] - 0.944) <= 0.05
    page = (tmp_path / "report" / "index.html").read_text()
    assert "<svg" in page and "n (patients)" in page and "src=" not in page and "url(http" not in page
    patients = pd.read_csv(tmp_path / "report" / "patients.tsv", sep="\t", dtype={"participant_id": str})
    assert len(patients) == 10
    again = run("report", pairs, "--out", tmp_path / "report")
    assert again.returncode == 10 and "is there already" in again.stderr


@pytest.mark.parametrize("arguments, code, sentence", [
    (["missing.tsv"], 3, "no table can be read"),
    (["PAIRS", "--against", "stage"], 2, "go together"),
    (["PAIRS", "--region", "liver"], 2, "there is no region 'liver'"),
    (["PAIRS", "--sd-reference", "-1"], 2, "allowed are 0 to 3"),
])
def test_mistakes_of_the_command_line(tmp_path, arguments, code, sentence):
    pairs = write(tmp_path, pairs_table(np.random.default_rng(11), targets=[2] * 10))
    done = run("report", *[pairs if a == "PAIRS" else a for a in arguments], "--out", tmp_path / "out")
    assert (done.returncode, sentence in done.stderr, (tmp_path / "out").exists()) == (code, True, False), done.stderr


def test_palpate_itself_needs_none_of_this():
    code = "import sys, palpate; sys.exit(any(m in sys.modules for m in ('pandas', 'statsmodels', 'matplotlib')))"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_participants_stand_once(tmp_path):
    path = tmp_path / "participants.tsv"
    path.write_text("participant_id\tstage\nA\tT1\nA\tT2\n")
    with pytest.raises(CohortError, match="stands twice"):
        read_participants(path)
