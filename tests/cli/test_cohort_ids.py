# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""A thousand odd identifiers: each is kept as it is or refused with its row, and no name of a file gets out."""
import csv
import random
import re

from tests.cli.test_cohort import LIMITS, SETTINGS, rows_of, run, status, write_volume
from tests.conftest import run_palpate

ALLOWED = re.compile(r"[A-Za-z0-9][A-Za-z0-9-]{0,31}", re.ASCII)
KNOWN = ["NA", "nan", "NaN", "NULL", "None", "null", "true", "007", "1e5", "0x10", "-0", "-rf", "--help", "..", ".", "../up", "a/b",
         "a\\b", "C:", "CON", "nul", "aux-1", "~", "~root", "$HOME", "`id`", "$(id)", "a;b", "a&b", "a|b", "a b", " a", "a ", "\ta", "a\tb",
         "a\nb", 'a"b', "a'b", "a,b", "a*", "?", "[a]", "{a}", "#a", "%s", "%00", "é", "ß", "患者", "пациент", "a\u0301", "\u200ba",
         "\u202eba", "\ufeffa", "🙂", "a" * 32, "a" * 33, "a" * 300, "-" * 5, "a-", "a--b", "A", "a_b", "a.nii", "reference", "target-01",
         "=1+1", "@a", "<b>a</b>", "&amp;", "a\x7fb", "a\x01b", "a\x1bb"]
CANARY = "Smith-Jane-1961"
MAY_NAME_FILES = {"plan.tsv", "problems.tsv", "hashes.tsv"}


def odd_ids():
    chance = random.Random(17)
    alphabet = [chr(code) for code in range(32, 127)] + list("éøЖ中\u00a0\u2028🙂") + ["..", "-", "/", "NA"]
    ids = list(dict.fromkeys(KNOWN))
    while len(ids) < 1000:
        # Half of them of what is allowed, so that as many are kept as are refused.
        letters = alphabet if chance.random() < 0.5 else "abcXYZ0189-"
        new = "".join(chance.choice(letters) for _ in range(chance.choice([1, 2, 3, 8, 31, 32, 33, 300])))
        if new not in ids:
            ids.append(new)
    return ids


def test_a_thousand_odd_ids_are_kept_or_refused(tmp_path):
    ids = odd_ids()
    inputs = tmp_path / CANARY
    inputs.mkdir()
    write_volume(inputs / f"{CANARY}-reference.nii", 1)
    write_volume(inputs / f"{CANARY}-target.nii", 2)
    (tmp_path / "organs.toml").write_text(SETTINGS)
    (tmp_path / "cohort.toml").write_text(LIMITS)
    with open(tmp_path / "pairs.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["participant_id", "reference", "target"])
        for name in ids:
            table.writerow([name, f"{CANARY}/{CANARY}-reference.nii", f"{CANARY}/{CANARY}-target.nii"])
    cohort = tmp_path / "cohort"
    arguments = ["cohort", "plan", tmp_path / "pairs.csv", "--out", cohort, "--settings", tmp_path / "organs.toml", "--config",
                 tmp_path / "cohort.toml", "--test-stub", 0, "--quiet"]
    good = [name for name in ids if ALLOWED.fullmatch(name)]
    assert 200 < len(good) < 800
    assert run_palpate(*arguments).returncode == 4 and not (cohort / "plan.json").exists()
    assert len(rows_of(cohort / "problems.tsv")) == len(ids) - len(good)
    assert run_palpate(*arguments, "--skip-bad").returncode == 0
    assert [row["participant_id"] for row in rows_of(cohort / "plan.tsv")] == good
    some = good[::40]
    finished = run(cohort, "--only", *some)
    assert finished.returncode == 0, finished.stderr
    code, counts = status(cohort)  # several threads count so many patients
    assert code == 9 and counts["patients"] == len(good) and counts["in_work"] == 0
    assert counts["cases"]["done"] == len(some) and counts["cases"]["waiting"] == len(good) - len(some)
    collected = run_palpate("cohort", "collect", cohort)
    assert collected.returncode == 0, collected.stderr
    rows = rows_of(cohort / "pairs.tsv")
    assert [row["participant_id"] for row in rows] == good
    assert {row["participant_id"] for row in rows if row["status"] == "done"} == set(some)
    assert {path.name for path in cohort.glob("cases/*/*") if list(path.glob("*/case.json"))} == set(some)
    # Nothing has left the cohort's folder.
    assert {path.name for path in tmp_path.iterdir()} == {CANARY, "organs.toml", "cohort.toml", "pairs.csv", "cohort"}
    for text in (finished.stdout, finished.stderr, collected.stdout, collected.stderr):
        assert CANARY not in text
    for path in cohort.rglob("*"):
        assert CANARY not in path.name
        if path.is_file() and path.name not in MAY_NAME_FILES:
            assert CANARY.encode() not in path.read_bytes(), path
