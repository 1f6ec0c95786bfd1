# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Settings that are damaged, endless or hostile are refused at once, in little memory."""
import pathlib
import subprocess
import sys

import pytest

from tests.conftest import PROGRAM

MOST_MEBIBYTES = 256
MIB = 1 << 20
KEYS = '[[organ]]\nname = "a"\nlabel = 1\nrole = "tissue"\nstiffness_kpa = {}\n[background]\n'

MEASURE = ("import resource, subprocess, sys, time\n"
           "begin = time.monotonic()\n"
           "done = subprocess.run(sys.argv[1:], capture_output=True, text=True, errors='replace')\n"
           "print(done.returncode, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1024,"
           " round(time.monotonic() - begin, 2), done.stderr)")

HARD = {
    "a million lists in each other": (b"a = " + b"[" * 1000000, 3),
    "a million tables in each other": (b"a = " + b"{a=" * 300000, 3),
    "a key of 400,000 parts": (b"a" + b".a" * 400000 + b" = 1", 3),
    "a table of 400,000 parts": (b"[a" + b".a" * 400000 + b"]", 3),
    "a quoted key of 200,000 parts": (b'"a"' + b'."a,="' * 100000 + b" = 1", 3),
    "dots behind an odd string": (b'x = ["""s"""", {a' + b".a" * 300000 + b"=1}]", 3),
    "90,000 keys": (b"".join(b"k%d=1\n" % k for k in range(90000)), 2),
    "95,000 organs": (b"[[organ]]\n" * 95000, 2),
    "a name of a megabyte": (b'[[organ]]\nname="' + b"x" * 1000000 + b'"', 2),
    "a key twice": (b"[background]\nstiffness_kpa=1\nstiffness_kpa=2", 3),
    "a table twice": (b"[background]\n[background]\n", 3),
    "NaN": (KEYS.format("nan").encode(), 2),
    "infinity": (KEYS.format("-inf").encode(), 2),
    "a number too large": (KEYS.format("1e999").encode(), 3),
    "a whole number too large": (b"[[organ]]\nname='a'\nlabel=99999999999999999999", 3),
    "a negative number": (KEYS.format("-1").encode(), 2),
    "an unknown key": (b"colour = 'red'", 2),
    "an unknown table": (b"[colours]\nred = 1", 2),
    "a NUL": (b'a = "\0"', 3),
    "no UTF-8": (b'a = "\xff\xfe"', 3),
    "UTF-16": ("a = 1".encode("utf-16"), 3),
    "YAML": (b"organ: !!python/object/apply:os.system ['touch escaped']\n", 3),
    "a pickle": (b"\x80\x04\x95\x1f\x00\x00\x00\x00\x00\x00\x00\x8c\x05posix\x94\x8c\x06system", 3),
    "JSON": (b'{"organ": []}', 3),
    "nothing": (b"", 2),
}


def measured(*words):
    finished = subprocess.run([sys.executable, "-c", MEASURE, str(PROGRAM), *map(str, words)],
                              capture_output=True, text=True, timeout=120, check=True)
    code, mebibytes, seconds, sentence = finished.stdout.split(maxsplit=3)
    print(f"{seconds} s, {mebibytes} MiB: {sentence[:150]}")
    assert len(sentence.strip().splitlines()) == 1 and sentence.startswith("palpate: "), sentence
    assert len(sentence) < 1000
    assert int(mebibytes) < MOST_MEBIBYTES
    return int(code)


@pytest.mark.parametrize("command", ["recover", "simulate"])
@pytest.mark.parametrize("name", HARD)
def test_is_refused(command, name, tmp_path):
    text, code = HARD[name]
    path = tmp_path / "hard.toml"
    path.write_bytes(text)
    words = ["recover", "a.nii", "a.nii", "--config", path, "--backend", "reference"]
    if command == "simulate":
        words = ["simulate", path]

    found = measured(*words, "--out", tmp_path / "out", "--quiet")

    assert found in (2, 3) and (command == "simulate" or found == code)
    assert [entry.name for entry in tmp_path.iterdir()] == ["hard.toml"]


@pytest.mark.parametrize("make", [
    lambda folder: "/dev/zero", lambda folder: folder, lambda folder: sparse(folder, 1 << 30)],
    ids=["an endless file", "a folder", "a gibibyte"])
def test_what_is_no_settings_file_is_refused(make, tmp_path):
    path = make(tmp_path)
    for words in (["recover", "a.nii", "a.nii", "--config", path, "--backend", "reference"], ["simulate", path]):
        assert measured(*words, "--out", tmp_path / "out", "--quiet") == 3


def sparse(folder, size):
    path = pathlib.Path(folder) / "large.toml"
    with open(path, "wb") as file:
        file.truncate(size)
    return path


@pytest.mark.parametrize("text", ["[" * 1000000, "{}", '{"study": 1, "settings": 2}', '{"study": "coverage", "settings": []}',
                                  '{"study": "coverage", "settings": {"version": 3}}', "not JSON"], ids=range(6))
def test_a_damaged_study_is_refused(text, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "study.json").write_text(text)
    code = measured("study", "coverage", "--phantoms", 1, "--backend", "reference", "--out", out, "--quiet")
    assert code == 10
    assert (out / "study.json").read_text() == text
