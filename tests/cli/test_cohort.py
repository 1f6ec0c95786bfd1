# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Cohorts through the command line: planning, and runs that are killed. The cases of most tests are the stub of
`plan --test-stub`, which sleeps in the place of every computation."""
import contextlib
import csv
import gzip
import json
import os
import re
import signal
import struct
import subprocess
import sys
import time

import numpy
import pytest

from tests.conftest import PROGRAM, ROOT, run_palpate

SETTINGS = ('[background]\nstiffness_kpa = 10.0\n\n[[organ]]\nname = "prostate"\nlabel = 1\nrole = "tissue"\n'
            'stiffness_kpa = "unknown"\n')
LIMITS = "[limits]\ntarget_seconds = 1.5\nattempts = 2\n"


def write_volume(path, value):
    """Two voxels along each axis, as NIfTI-1."""
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, 2, 2, 2, 1, 1, 1, 1)
    struct.pack_into("<2h", header, 70, 2, 8)
    struct.pack_into("<8f", header, 76, 1, 1, 1, 1, 1, 1, 1, 1)
    struct.pack_into("<f", header, 108, 352)
    struct.pack_into("<h", header, 254, 1)
    for row in range(3):
        struct.pack_into("<f", header, 280 + 20 * row, 1)
    header[344:348] = b"n+1\0"
    path.write_bytes(bytes(header) + value.to_bytes(2, "little") + bytes(6))


def table_of(folder, patients, cases, ids=()):
    """A table of `patients` with `cases` targets each, and one patient more for every further case id."""
    rows = ["participant_id\treference\ttarget\tcase_id"]
    (folder / "organs.toml").write_text(SETTINGS)
    (folder / "cohort.toml").write_text(LIMITS)
    number = 1
    pairs = [(f"p{p}", "") for p in range(patients) for _ in range(cases)] + [(f"x{k}", i) for k, i in enumerate(ids)]
    for participant, case in pairs:
        reference = folder / f"{participant}.nii"
        if not reference.exists():
            write_volume(reference, number)
        write_volume(folder / f"t{number}.nii", number + 20000)
        rows.append(f"{participant}\t{reference.name}\tt{number}.nii\t{case}")
        number += 1
    (folder / "pairs.tsv").write_text("\n".join(rows) + "\n")
    return folder / "pairs.tsv"


def plan(folder, *more, patients=0, cases=0, ids=(), seconds=0.05):
    table = table_of(folder, patients, cases, ids)
    finished = run_palpate("cohort", "plan", table, "--out", folder / "cohort", "--settings", folder / "organs.toml",
                           "--config", folder / "cohort.toml", "--test-stub", seconds, "--quiet", *more)
    assert finished.returncode == 0, finished.stderr
    return folder / "cohort"


def run(cohort, *more):
    return run_palpate("cohort", "run", cohort, "--progress", "json", *more)


def started(cohort, *more):
    return subprocess.Popen([str(PROGRAM), "cohort", "run", str(cohort), "--progress", "json", *more],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def status(cohort):
    finished = run_palpate("cohort", "status", cohort, "--json")
    return finished.returncode, json.loads(finished.stdout)


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file, delimiter="\t"))


def journal_cases(cohort):
    """(patient, case) of every row that runners noted."""
    lines = [line for file in (cohort / "journal").iterdir() for line in file.read_text().splitlines()]
    records = [json.loads(line[line.index("{"):]) for line in lines]
    return [(record["patient"], record["case"]) for record in records]


def assert_each_case_is_done_once(cohort, number):
    """After processes were killed. One that is killed between the end of a case and its row in the journal leaves that row
    out: the folders decide, and the journal only never tells a case twice."""
    noted = journal_cases(cohort)
    assert len(noted) == len(set(noted)) <= number
    assert len(list((cohort / "cases").rglob("case.json"))) == number


def children_of(pid):
    return [int(child) for child in open(f"/proc/{pid}/task/{pid}/children").read().split()]


def wait_until(true, seconds=10):
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_a_cohort_is_planned_run_counted_and_collected(tmp_path):
    cohort = plan(tmp_path, patients=3, cases=2)
    assert not (cohort / "plan.tsv").stat().st_mode & 0o222 and not (cohort / "plan.json").stat().st_mode & 0o222
    assert status(cohort)[0] == 9 and status(cohort)[1]["cases"]["waiting"] == 6
    finished = run(cohort, "--jobs", 2)
    assert finished.returncode == 0, finished.stderr
    assert len(finished.stdout.splitlines()) == 6
    assert status(cohort) == (0, status(cohort)[1]) and status(cohort)[1]["cases"]["done"] == 6
    collected = run_palpate("cohort", "collect", cohort)
    assert collected.returncode == 0, collected.stderr
    rows = rows_of(cohort / "pairs.tsv")
    assert len(rows) == 6 and all(row["status"] == "done" and row["e_kpa"] == "50" for row in rows)
    assert set(rows[0]) == set(json.loads((cohort / "pairs.json").read_text()))
    patient, *_ = rows_of(cohort / "patients.tsv")
    assert patient["participant_id"] == "p0" and patient["pairs"] == "2" and patient["mean_kpa"] == "50"
    assert "</html>" in (cohort / "index.html").read_text()
    assert run(cohort).stdout == "" and len(journal_cases(cohort)) == 6  # nothing is done again


def test_no_table_of_results_holds_a_path(tmp_path):
    cohort = plan(tmp_path, patients=1, cases=2)
    run(cohort)
    run_palpate("cohort", "collect", cohort)
    allowed = {"plan.tsv", "problems.tsv", "hashes.tsv"}
    for path in cohort.rglob("*"):
        if path.is_file() and path.name not in allowed:
            assert b".nii" not in path.read_bytes() and str(tmp_path).encode() not in path.read_bytes(), path


def test_bad_rows_are_told_all_at_once(tmp_path):
    table = table_of(tmp_path, 1, 1)
    lines = table.read_text().splitlines()
    bad = ["../up\tp0.nii\tt1.nii\t", "-rf\tp0.nii\tt1.nii\t", "a b\tp0.nii\tt1.nii\t", f"{'x' * 33}\tp0.nii\tt1.nii\t",
           "a\tmissing.nii\tt1.nii\t", "b\tp0.nii\tp0.nii\t", "c\tp0.nii", "d\tp0.nii\torgans.toml\t"]
    table.write_text("\n".join(lines + bad) + "\n")
    out = tmp_path / "cohort"
    arguments = ["cohort", "plan", table, "--out", out, "--settings", tmp_path / "organs.toml", "--quiet"]
    finished = run_palpate(*arguments)
    assert finished.returncode == 4 and "problems.tsv" in finished.stderr
    assert not (out / "plan.json").exists()
    assert {row["row"] for row in rows_of(out / "problems.tsv")} == {str(k) for k in range(3, 11)}
    finished = run_palpate(*arguments, "--skip-bad")
    assert finished.returncode == 0 and "8 bad rows" in finished.stdout
    assert status(out)[1]["bad_rows_left_out"] == 8 and status(out)[1]["cases"]["waiting"] == 1
    again = run_palpate(*arguments)
    assert again.returncode == 10 and "--overwrite" in again.stderr


def test_ids_stay_text(tmp_path):
    table = table_of(tmp_path, 1, 1)
    row = table.read_text().splitlines()[1]
    table.write_text("participant_id\treference\ttarget\tcase_id\n" +
                     "".join(row.replace("p0\t", f"{i}\t") + "\n" for i in ("007", "NA", "nan", "1e5")))
    out = tmp_path / "cohort"
    assert run_palpate("cohort", "plan", table, "--out", out, "--settings", tmp_path / "organs.toml", "--test-stub", 0,
                       "--quiet").returncode == 0
    run(out)
    run_palpate("cohort", "collect", out)
    assert [row["participant_id"] for row in rows_of(out / "pairs.tsv")] == ["007", "NA", "nan", "1e5"]


def test_crashes_hangs_and_silence_cost_one_pair_each(tmp_path):
    ids = ("crash-1", "hang-1", "silent-1", "fail-4", "crash-once")
    cohort = plan(tmp_path, patients=2, cases=2, ids=ids)
    finished = run(cohort, "--jobs", 3)
    assert finished.returncode == 7, finished.stderr
    code, counts = status(cohort)
    assert code == 7 and counts["cases"]["done"] == 5 and counts["cases"]["failed"] == 4
    run_palpate("cohort", "collect", cohort)
    rows = {row["case_id"]: row for row in rows_of(cohort / "pairs.tsv")}
    assert "signal 11" in rows["crash-1"]["verdict"] and rows["crash-1"]["code"] == "1"
    assert "longer than 3 s" in rows["hang-1"]["verdict"] and rows["hang-1"]["code"] == "9"
    assert "no result" in rows["silent-1"]["verdict"]
    assert rows["fail-4"]["code"] == "4" and rows["crash-once"]["status"] == "done"
    failure = json.loads(next((cohort / "failed").rglob("*crash-1.json")).read_text())
    assert failure["attempts"] == 2
    assert run(cohort).returncode == 7 and len(journal_cases(cohort)) == 5
    assert run(cohort, "--retry-failed").returncode == 7


def test_killed_runners_and_children_lose_nothing(tmp_path):
    cohort = plan(tmp_path, patients=20, cases=3, seconds=0.02)
    kills = 0
    while status(cohort)[0] == 9:
        driver = started(cohort, "--jobs", "3")
        end = time.monotonic() + 0.6
        while time.monotonic() < end and driver.poll() is None:
            time.sleep(0.1)
            for child in children_of(driver.pid)[:1] if driver.poll() is None else []:
                with contextlib.suppress(ProcessLookupError):  # it ended meanwhile
                    os.kill(child, signal.SIGKILL)
        if driver.poll() is None and kills < 6:
            children = children_of(driver.pid)
            driver.kill()
            kills += 1
            driver.wait()
            wait_until(lambda: not any(os.path.exists(f"/proc/{child}/exe") and
                                       f"{cohort}" in open(f"/proc/{child}/cmdline").read() for child in children), 2)
        driver.communicate(timeout=60)
        # Children that were killed twice are failures of their pairs; those are tried again.
        for file in (cohort / "failed").rglob("*.json"):
            file.unlink()
    assert kills > 0
    code, counts = status(cohort)
    assert code == 0 and counts["cases"]["done"] == 60
    assert_each_case_is_done_once(cohort, 60)
    assert not list((cohort / "cases").rglob("*.unfinished-*"))


def test_the_same_command_twice_at_once_starts_every_case_once(tmp_path):
    cohort = plan(tmp_path, patients=12, cases=2)
    both = [started(cohort, "--jobs", "2"), started(cohort, "--jobs", "2")]
    lines = [line for one in both for line in one.communicate(timeout=60)[0].splitlines()]
    assert [one.returncode for one in both] == [0, 0]
    noted = journal_cases(cohort)
    assert len(noted) == len(set(noted)) == len(lines) == 24


def test_sigterm_ends_a_run_within_two_seconds(tmp_path):
    cohort = plan(tmp_path, patients=3, cases=2, seconds=5)
    driver = started(cohort, "--jobs", "2")
    wait_until(lambda: children_of(driver.pid))
    begin = time.monotonic()
    driver.terminate()
    driver.communicate(timeout=10)
    assert driver.returncode == 9 and time.monotonic() - begin < 2
    assert status(cohort)[1]["in_work"] == 0 and status(cohort)[1]["cases"]["waiting"] == 6


def test_shards_share_the_work(tmp_path):
    cohort = plan(tmp_path, patients=5, cases=1, seconds=0)
    for number in (1, 2):
        assert run(cohort, "--shard", f"{number}/3").returncode == 0
    assert status(cohort)[0] == 9
    finished = run_palpate("cohort", "run", cohort, "--shard", "auto", environment={
        "SLURM_ARRAY_TASK_ID": "3", "SLURM_ARRAY_TASK_MIN": "1", "SLURM_ARRAY_TASK_MAX": "3"})
    assert finished.returncode == 0 and status(cohort)[0] == 0
    assert run(cohort, "--shard", "4/3").returncode == 2


def test_results_of_other_settings_are_stale_until_they_are_replaced(tmp_path):
    cohort = plan(tmp_path, patients=2, cases=1, seconds=0)
    assert run(cohort).returncode == 0
    (tmp_path / "cohort.toml").write_text(LIMITS + "[recover]\nnodes = 7000\n")
    arguments = ["cohort", "plan", tmp_path / "pairs.tsv", "--out", cohort, "--settings", tmp_path / "organs.toml",
                 "--config", tmp_path / "cohort.toml", "--test-stub", 0, "--quiet", "--overwrite"]
    assert run_palpate(*arguments).returncode == 0
    assert status(cohort)[1]["cases"]["stale"] == 2
    refused = run_palpate("cohort", "collect", cohort)
    assert refused.returncode == 4 and "--mixed" in refused.stderr
    assert run_palpate("cohort", "collect", cohort, "--mixed").returncode == 0
    assert run(cohort).returncode == 0 and status(cohort)[1]["cases"]["done"] == 2


def test_a_case_with_a_damaged_row_in_the_journal_is_read_from_its_folder(tmp_path):
    cohort = plan(tmp_path, patients=2, cases=2, seconds=0)
    run(cohort)
    journal, = (cohort / "journal").iterdir()
    lines = journal.read_text().splitlines()
    journal.write_text(lines[0][:60] + "\n" + lines[1].replace("{", "[", 1) + "\n" + lines[2] + "\n" + lines[3][:-4])
    assert status(cohort)[0] == 0
    run_palpate("cohort", "collect", cohort)
    assert [row["e_kpa"] for row in rows_of(cohort / "pairs.tsv")] == ["50"] * 4


def test_another_plan_table_is_refused(tmp_path):
    cohort = plan(tmp_path, patients=1, cases=2, seconds=0)
    table = cohort / "plan.tsv"
    table.chmod(0o644)
    table.write_text(table.read_text().replace("t2.nii", "t9.nii"))
    for command in ("run", "status", "collect"):
        refused = run_palpate("cohort", command, cohort)
        assert refused.returncode == 3 and "not the one" in refused.stderr


def gallery_rows(cohort):
    rows = []
    for file in sorted((cohort / "gallery").glob("rows-*.js")):
        text = file.read_text()
        rows += json.loads(text[text.index("["):text.rindex(",\n]")] + "]")
    return rows


def test_the_gallery_has_every_case_and_takes_ratings_back(tmp_path):
    cohort = plan(tmp_path, patients=2, cases=2, ids=("fail-4",), seconds=0)
    run(cohort)
    assert run_palpate("cohort", "collect", cohort).returncode == 0
    rows = gallery_rows(cohort)
    assert len(rows) == 5 and "asked to" in rows[-1][7]  # what failed has no picture, and comes last
    for row in rows[:4]:
        assert (cohort / "cases" / row[0] / "card.svg").stat().st_size < 6000 and row[5][0][:2] == ["test stub", "recovered"]
    page = (cohort / "gallery.html").read_text()
    assert "http" not in re.sub(r"http-equiv|http://www.w3.org/2000/svg", "", page) and "fetch(" not in page
    lines = ["patient\tcase_id\trating\tkey"]
    for row, rating, key in zip(rows, ("reject", "accept", "unsure"), (rows[0][3], rows[1][3], "0" * 16)):
        lines.append("\t".join([*row[0].split("/")[1:], rating, key]))
    (cohort / "ratings.tsv").write_text("\n".join(lines) + "\n")
    collected = run_palpate("cohort", "collect", cohort)
    assert collected.returncode == 0 and "1 ratings are of results" in collected.stdout
    assert sorted(row["rating"] for row in rows_of(cohort / "pairs.tsv")) == ["", "", "", "accept", "reject"]
    assert sum(int(row["identified"]) for row in rows_of(cohort / "patients.tsv")) == 3
    assert "rejected in the gallery" in (cohort / "index.html").read_text()
    (cohort / "ratings.tsv").write_text("\n".join(lines).replace("accept", "splendid") + "\n")
    refused = run_palpate("cohort", "collect", cohort)
    assert refused.returncode == 4 and "line 3" in refused.stderr and "splendid" in refused.stderr


def test_labels_that_are_missing_are_told_when_planning(tmp_path):
    table = table_of(tmp_path, 1, 2)
    # Voxels of a byte: 20001 and 20002 are 33 and 34, each beside 78.
    (tmp_path / "organs.toml").write_text(SETTINGS.replace("label = 1\n", "label = 34\n"))
    arguments = ["cohort", "plan", table, "--out", tmp_path / "cohort", "--settings", tmp_path / "organs.toml", "--quiet"]
    refused = run_palpate(*arguments, "--check", "voxels")
    assert refused.returncode == 4
    problems = rows_of(tmp_path / "cohort/problems.tsv")
    assert {(row["row"], row["column"]) for row in problems} == {("2", "reference"), ("2", "target"), ("3", "reference")}
    assert all("no voxel has label 34" in row["problem"] for row in problems)
    assert run_palpate(*arguments).returncode == 0  # headers only


def test_planning_again_reads_only_files_that_changed(tmp_path):
    cohort = plan(tmp_path, patients=2, cases=2)
    known = (cohort / "plan.tsv").read_text()
    write_volume(tmp_path / "t1.nii", 777)
    run_palpate("cohort", "plan", tmp_path / "pairs.tsv", "--out", cohort, "--settings", tmp_path / "organs.toml", "--config",
                tmp_path / "cohort.toml", "--test-stub", 0.05, "--quiet", "--overwrite")
    different = [a for a, b in zip(known.splitlines(), (cohort / "plan.tsv").read_text().splitlines()) if a != b]
    assert len(different) == 1 and "t1.nii" in different[0]


def test_the_load_script_measures_every_command(tmp_path):
    finished = subprocess.run([sys.executable, str(ROOT / "scripts/cohort_load"), "33", "330", "--folder", str(tmp_path), "--palpate",
                               str(PROGRAM), "--cards", "--keep"], capture_output=True, text=True, timeout=300)
    assert finished.returncode in (0, 1), finished.stderr  # 1: a busy machine
    lines = [line.split("\t") for line in finished.stdout.splitlines()[1:]]
    assert [line[1] for line in lines if line[0] == "330"] == ["plan", "plan again", "status", "collect"]
    rows = rows_of(tmp_path / "330/cohort/pairs.tsv")
    assert len(rows) == 330 and sum(row["status"] == "failed" for row in rows) < 20
    assert sum(row["device"] == "stub" for row in rows) > 300  # taken from the journal
    assert len(gallery_rows(tmp_path / "330/cohort")) == 330


def test_wrong_options_of_recover_are_told_when_planning(tmp_path):
    table = table_of(tmp_path, 1, 1)
    for text, word in (("[recover]\nout = 'x'\n", "out"), ("[recover]\nnodes = 3\n", "nodes"), ("[nonsense]\n", "nonsense")):
        (tmp_path / "cohort.toml").write_text(text)
        finished = run_palpate("cohort", "plan", table, "--out", tmp_path / "cohort", "--config", tmp_path / "cohort.toml",
                               "--settings", tmp_path / "organs.toml", "--quiet")
        assert finished.returncode == 2 and word in finished.stderr


@pytest.mark.parametrize("keep", ["table", "compact", "all"])
def test_a_phantom_is_recovered_as_by_itself(tmp_path, phantom, keep):
    table = tmp_path / "pairs.csv"
    table.write_text("participant_id,reference,target,config\n"
                     f"p,{phantom}/reference.nii.gz,{phantom}/target.nii.gz,{phantom}/organs.toml\n"
                     f"p,{phantom}/reference.nii.gz,{tmp_path}/bad.nii,{phantom}/organs.toml\n")
    write_volume(tmp_path / "bad.nii", 9)
    (tmp_path / "cohort.toml").write_text("[recover]\nnodes = 2500\n")
    cohort = tmp_path / "cohort"
    planned = run_palpate("cohort", "plan", table, "--out", cohort, "--config", tmp_path / "cohort.toml", "--keep", keep,
                          "--quiet")
    assert planned.returncode == 0, planned.stderr
    finished = run(cohort)
    assert finished.returncode == 7, finished.stderr  # of the second target
    run_palpate("cohort", "collect", cohort)
    good, bad = rows_of(cohort / "pairs.tsv")
    folder = next(cohort.glob("cases/*/p/target-01"))
    result = json.loads((folder / "result.json").read_text())
    region, = [r for r in result["regions"] if r["unknown"]]
    assert float(good["e_kpa"]) == pytest.approx(region["stiffness_kpa"], rel=1e-5)
    assert bad["status"] == "failed" and bad["code"] in ("3", "4") and "bad.nii" not in bad["verdict"]
    assert (folder / "report.html").exists() == (keep == "all")
    if keep == "compact":
        mesh, = cohort.glob("cases/*/p/reference/mesh-*.vtu")
        assert json.loads((folder / "case.json").read_text())["mesh"] == mesh.name
        assert numpy.load(folder / "displacement.npy").shape == (result["mesh"]["nodes"], 3)
        assert 0 < len(numpy.load(folder / "force.npy")) < result["mesh"]["nodes"]


@pytest.mark.parametrize("target", ["target", "reference"])  # recovered; nothing to see, both ends from the prior
def test_a_compact_case_is_expanded_to_what_recover_writes(target, tmp_path, phantom):
    # compressed anew: plans refuse a target of the reference's bytes
    volume = gzip.decompress((phantom / f"{target}.nii.gz").read_bytes())
    (tmp_path / "later.nii.gz").write_bytes(gzip.compress(volume, 1))
    (tmp_path / "pairs.csv").write_text("participant_id,reference,target\n"
                                        f"p,{phantom}/reference.nii.gz,later.nii.gz\n")
    (tmp_path / "cohort.toml").write_text("[recover]\nnodes = 2500\n")
    cohorts = {keep: tmp_path / keep for keep in ("compact", "all")}
    for keep, cohort in cohorts.items():
        planned = run_palpate("cohort", "plan", tmp_path / "pairs.csv", "--out", cohort, "--config", tmp_path / "cohort.toml",
                              "--settings", phantom / "organs.toml", "--keep", keep, "--quiet")
        assert planned.returncode == 0, planned.stderr
        assert run(cohort).returncode == 0
    finished = run_palpate("cohort", "expand", cohorts["compact"], "p/target-01", "--quiet")
    assert finished.returncode == 0, finished.stderr
    made = cohorts["compact"] / "expanded/p/target-01"
    direct = next(cohorts["all"].glob("cases/*/p/target-01"))
    assert {f.name for f in made.iterdir()} == {f.name for f in direct.iterdir()} - {"case.json", "card.svg"}
    results = [json.loads((folder / "result.json").read_text()) for folder in (made, direct)]
    assert any("prior" in (region["lower_end_from"], region["upper_end_from"])
               for region in results[1]["regions"]) == (target == "reference")
    for result in results:
        result.pop("timings_s")
        result["summary"] = [re.sub(r" in [0-9.]+ s", "", sentence) for sentence in result["summary"]]
    assert_nearly_equal(*results)
    for name in sorted(f.name for f in direct.glob("*.nii.gz")):
        one, other = (gzip.decompress((folder / name).read_bytes()) for folder in (made, direct))
        assert len(one) == len(other)
        different = numpy.frombuffer(one[352:], "u1") != numpy.frombuffer(other[352:], "u1")
        assert different.mean() < 1e-3  # the motion is kept in float32
    kept = sum(f.stat().st_size for f in next(cohorts["compact"].glob("cases/*/p/target-01")).iterdir())
    assert kept < 0.2e6
    refused = run_palpate("cohort", "expand", cohorts["all"], "p/target-01", "--quiet")
    assert refused.returncode == 4 and "compact" in refused.stderr
    assert run_palpate("cohort", "expand", cohorts["compact"], "p/none", "--quiet").returncode == 2
    facts = next(cohorts["compact"].glob("cases/*/p/target-01/facts.gz"))
    facts.write_bytes(facts.read_bytes()[:-9])
    broken = run_palpate("cohort", "expand", cohorts["compact"], "p/target-01", "--out", tmp_path / "new", "--quiet")
    assert broken.returncode == 3 and "facts.gz" in broken.stderr and not (tmp_path / "new").exists()


def assert_nearly_equal(one, other, place=""):
    """Numbers to what float32 leaves of the motion."""
    if isinstance(one, dict):
        assert one.keys() == other.keys(), place
        for key in one:
            assert_nearly_equal(one[key], other[key], f"{place}/{key}")
    elif isinstance(one, list):
        assert len(one) == len(other), place
        for k, pair in enumerate(zip(one, other)):
            assert_nearly_equal(*pair, f"{place}/{k}")
    elif isinstance(one, float) or isinstance(other, float):
        assert one == pytest.approx(other, rel=1e-4, abs=1e-5), place
    else:
        assert one == other, place
