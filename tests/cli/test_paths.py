# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Odd names of files and folders are taken literally; nothing is read or written outside what was
named, and no shell sees a name."""
import os
import pathlib

import pytest

from tests import hard_images
from tests.cli.test_hard_images import SETTINGS
from tests.conftest import recover_arguments, run_palpate

MODEL = """
[mesh]
box = {size_mm = [4, 4, 4], divisions = [2, 2, 2]}
[[material]]
law = "linear"
stiffness_kpa = 10
poisson_ratio = 0.3
[[fix]]
name = "bottom"
where = {side = "z-min"}
[[move]]
name = "top"
where = {side = "z-max"}
z_mm = 0.1
"""

ODD_NAMES = ["a b", "-rf", "--help", "ünïcode", "漢字", "🦴", "new\nline", "tab\there", "quo'te", 'quo"te',
             "$(touch escaped)", "`touch escaped`", "; touch escaped", "| touch escaped", "&& touch escaped",
             "*", "?", "~", "%s%n", "{}", "\\", "..a", "...", "x" * 200]


def tree(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def read(path, folder, **more):
    """Reads a volume through the command line, in `folder`; the code and the sentence."""
    settings = folder / "organs.toml"
    settings.write_text(SETTINGS)
    finished = run_palpate("recover", path, path, "--config", settings, "--out", folder / "out", "--backend",
                           "reference", "--quiet", **more)
    assert not (folder / "out").exists()
    assert finished.stderr.startswith("palpate: ")
    return finished.returncode, finished.stderr


@pytest.mark.parametrize("name", ODD_NAMES)
def test_an_odd_name_of_a_volume_is_taken_literally(name, tmp_path):
    path = tmp_path / f"{name}.nii"
    path.write_bytes(hard_images.nifti())
    before = tree(tmp_path)

    code, sentence = read(path, tmp_path)

    assert (code, "labels present: 0, 1" in sentence) == (4, True), sentence
    assert tree(tmp_path) == sorted([*before, "organs.toml"])


@pytest.mark.parametrize("name", ODD_NAMES)
def test_an_odd_name_of_a_result_folder_is_taken_literally(name, tmp_path):
    work = tmp_path / "work"
    work.mkdir()
    model = tmp_path / "model.toml"
    model.write_text(MODEL)

    finished = run_palpate("simulate", model, "--out", work / name, "--quiet")

    assert finished.returncode == 0, finished.stderr
    assert os.listdir(work) == [name]
    assert (work / name / "report.html").exists()
    assert sorted(os.listdir(tmp_path)) == ["model.toml", "work"]


def no_file(folder):
    return folder / "nothing.nii"


def a_folder(folder):
    (folder / "folder.nii").mkdir()
    return folder / "folder.nii"


def a_pipe(folder):
    os.mkfifo(folder / "pipe.nii")
    return folder / "pipe.nii"


def a_loop(folder):
    (folder / "loop.nii").symlink_to("loop.nii")
    return folder / "loop.nii"


def a_dangling_link(folder):
    (folder / "link.nii").symlink_to("/nowhere/at/all.nii")
    return folder / "link.nii"


def a_device(folder):
    (folder / "zero.nii").symlink_to("/dev/zero")
    return folder / "zero.nii"


def a_long_name(folder):
    return folder / ("n" * 300 + ".nii")


def a_long_path(folder):
    return pathlib.Path(str(folder) + "/d" * 2100 + "/a.nii")


def an_empty_name(folder):
    return ""


def below_a_file(folder):
    (folder / "file").write_text("x")
    return folder / "file" / "a.nii"


def a_foreign_file(folder):
    return "/etc/passwd"


@pytest.mark.parametrize("make", [no_file, a_folder, a_pipe, a_loop, a_dangling_link, a_device, a_long_name,
                                  a_long_path, an_empty_name, below_a_file, a_foreign_file])
def test_what_is_no_file_is_refused(make, tmp_path):
    code, sentence = read(make(tmp_path), tmp_path)

    assert code == 3, sentence
    assert "root:" not in sentence


def test_links_and_dots_that_lead_to_a_file_are_followed(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "real.nii").write_bytes(hard_images.nifti())
    (tmp_path / "link.nii").symlink_to("real.nii")
    for path in (tmp_path / "link.nii", tmp_path / "a/../real.nii", tmp_path / "./a/.././real.nii"):
        assert read(path, tmp_path)[0] == 4


DETACHED = ["/etc/passwd", "../secret.raw", "sub/../../secret.raw", "./../work/../secret.raw", "out.raw",
            "sub/out.raw", "~/secret.raw", "file:///etc/passwd", "http://localhost/x.raw", "|cat /etc/passwd",
            "C:\\secret.raw", "$(touch escaped)", "secret%d.raw", "LIST", ".", "", "sub"]


@pytest.mark.parametrize("name", DETACHED)
@pytest.mark.parametrize("kind", ["nhdr", "mhd"])
def test_a_header_does_not_lead_out_of_its_folder(kind, name, tmp_path):
    work = tmp_path / "work"
    (work / "sub").mkdir(parents=True)
    (tmp_path / "secret.raw").write_bytes(hard_images.labels())
    (work / "out.raw").symlink_to("../secret.raw")
    (work / "sub/out.raw").symlink_to("../../secret.raw")
    path = work / f"a.{kind}"
    path.write_bytes(hard_images.nrrd(b"", [("data file", name)]) if kind == "nhdr" else
                     hard_images.meta(b"", [("ElementDataFile", name)]))
    before = tree(tmp_path)

    code, sentence = read(path, tmp_path)

    assert code == 3, sentence
    assert tree(tmp_path) == sorted([*before, "organs.toml"])


def test_data_in_a_folder_below_are_read(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub/a.raw").write_bytes(hard_images.labels())
    (tmp_path / "a.nhdr").write_bytes(hard_images.nrrd(b"", [("data file", "sub/a.raw")]))
    assert "labels present: 0, 1" in read(tmp_path / "a.nhdr", tmp_path)[1]


@pytest.mark.parametrize("out, code", [
    ("", 10), ("/", 10), (".", 10), ("..", 10), ("taken", 10), ("taken/below", 10), ("dangling", 10),
    ("/dev/null/x", 10), ("/proc/x", 10), ("n" * 300, 10), ("d/" * 2100 + "x", 10), ("a/b/c", 0), ("a/../b", 0),
    ("link/inside", 0),
])
def test_a_result_goes_where_it_was_told_or_nowhere(out, code, tmp_path, monkeypatch):
    work = tmp_path / "work"
    (work / "real").mkdir(parents=True)
    (work / "taken").write_text("mine")
    (work / "link").symlink_to("real")
    (work / "dangling").symlink_to(tmp_path / "elsewhere")
    model = tmp_path / "model.toml"
    model.write_text(MODEL)
    monkeypatch.chdir(work)
    before = tree(tmp_path)

    finished = run_palpate("simulate", model, "--out", out, "--quiet")

    assert finished.returncode == code or (out == "" and finished.returncode == 2), finished.stderr
    if code == 0:
        assert (work / out / "report.html").exists() or (work / "b/report.html").exists()
    else:
        assert tree(tmp_path) == before
        assert len(finished.stderr.strip().splitlines()) == 1
    assert (work / "taken").read_text() == "mine"


def test_names_of_organs_are_not_names_of_files(phantom, tmp_path):
    work = tmp_path / "work"
    work.mkdir()
    config = tmp_path / "organs.toml"
    text = (phantom / "organs.toml").read_text()
    config.write_text(text.replace('"prostate"', '"../../escaped"')
                      .replace('"bladder"', '"<script>alert(1)</script>"').replace('"rectum"', '"/tmp/escaped; ls"'))

    finished = run_palpate(*recover_arguments(phantom, work / "out", config=config))

    assert finished.returncode in (0, 7), finished.stderr
    assert os.listdir(work) == ["out"] and sorted(os.listdir(tmp_path)) == ["organs.toml", "work"]
    assert "<script>alert(1)" not in (work / "out/report.html").read_text()
    assert not pathlib.Path("/tmp/escaped").exists()


@pytest.mark.parametrize("name", ["a\\nb", "a\\u0000b", "a\\u007fb", "", "x" * 65])
def test_names_of_organs_are_printable_and_short(name, phantom, tmp_path):
    config = tmp_path / "organs.toml"
    config.write_text((phantom / "organs.toml").read_text().replace('"prostate"', f'"{name}"'))

    finished = run_palpate(*recover_arguments(phantom, tmp_path / "out", config=config))

    assert finished.returncode == 2 and "name" in finished.stderr, finished.stderr
    assert len(finished.stderr.strip().splitlines()) == 1
