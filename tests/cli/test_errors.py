# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Each mistake gives its own exit code, one line that names it, and leaves nothing behind."""
import nibabel
import numpy
import pytest

from tests.conftest import recover_arguments, run_palpate, with_unknown_ratio


def fails_cleanly(finished, out, code, *words):
    assert finished.returncode == code, finished.stderr
    lines = finished.stderr.strip().splitlines()
    assert len(lines) == 1 and lines[0].startswith("palpate: "), finished.stderr
    for word in words:
        assert word in lines[0], lines[0]
    assert not out.exists()
    assert [entry for entry in out.parent.iterdir() if entry.name.startswith((".", "out"))] == []


@pytest.fixture
def out(tmp_path):
    folder = tmp_path / "work"
    folder.mkdir()
    return folder / "out"


def edited(phantom, tmp_path, old, new):
    config = tmp_path / "organs.toml"
    text = (phantom / "organs.toml").read_text()
    assert old in text
    config.write_text(text.replace(old, new))
    return config


def test_an_unknown_option_is_a_usage_error(phantom, out):
    fails_cleanly(run_palpate(*recover_arguments(phantom, out, "--bogus")), out, 2, "--bogus")


@pytest.mark.parametrize("words, sentence", [
    (["recovr", "a"], "there is no command 'recovr'; there are recover, phantom"),
    (["study", "foo", "--out", "x"], "study: foo not in {coverage,"),
    (["warp", "--inverse"], "A subcommand is required"),
    (["export", "a", "--walls", "foo", "--out", "b.feb"], "foo not in {displacement,force}"),
    (["recover", "a", "b", "--config", "c", "--out", "o", "--fields", "both"], "both not in {none,one,all}"),
])
def test_a_mistyped_word_is_named_with_what_is_allowed(words, sentence, out):
    fails_cleanly(run_palpate(*words), out, 2, sentence)


def test_an_unknown_linear_solver_is_a_usage_error(phantom, out):
    finished = run_palpate(*recover_arguments(phantom, out, "--linear-solver", "magic"))
    fails_cleanly(finished, out, 2, "--linear-solver", "magic", "multigrid", "direct")


def test_a_missing_input_file_is_named(phantom, out):
    finished = run_palpate(*recover_arguments(phantom, out, reference="nowhere.nii.gz"))
    fails_cleanly(finished, out, 3, "nowhere.nii.gz")


def test_a_missing_settings_file_is_named(phantom, out):
    finished = run_palpate(*recover_arguments(phantom, out, config="nowhere.toml"))
    fails_cleanly(finished, out, 3, "nowhere.toml")


def test_a_misspelt_setting_is_named(phantom, out, tmp_path):
    config = edited(phantom, tmp_path, "poisson_ratio", "poison_ratio")
    finished = run_palpate(*recover_arguments(phantom, out, config=config))
    fails_cleanly(finished, out, 2, "poison_ratio")


def test_an_unknown_poisson_ratio_does_not_go_with_a_saved_model(phantom, out, tmp_path):
    config = with_unknown_ratio(phantom, tmp_path)
    for option, value in (("--save-reduced", out.parent / "out.palpate"), ("--method", "nested-lbfgs")):
        finished = run_palpate(*recover_arguments(phantom, out, option, value, config=config))
        fails_cleanly(finished, out, 2, option, "poisson_ratio")


def test_a_damaged_volume_is_refused(phantom, out, tmp_path):
    damaged = tmp_path / "half.nii.gz"
    data = (phantom / "target.nii.gz").read_bytes()
    damaged.write_bytes(data[:len(data) // 2])
    finished = run_palpate(*recover_arguments(phantom, out, target=damaged))
    fails_cleanly(finished, out, 3, "half.nii.gz")


def test_a_four_dimensional_volume_is_refused(phantom, out, tmp_path):
    volume = tmp_path / "series.nii.gz"
    nibabel.save(nibabel.Nifti1Image(numpy.ones((8, 8, 8, 2), numpy.uint8), numpy.eye(4)), volume)
    finished = run_palpate(*recover_arguments(phantom, out, target=volume))
    assert finished.returncode in (3, 4)
    fails_cleanly(finished, out, finished.returncode, "series.nii.gz")


def test_a_label_that_is_not_there_is_named(phantom, out, tmp_path):
    config = edited(phantom, tmp_path, "label = 1", "label = 77")
    finished = run_palpate(*recover_arguments(phantom, out, config=config))
    fails_cleanly(finished, out, 4, "77", "prostate")


def test_organs_that_do_not_overlap_are_named(phantom, out, tmp_path):
    image = nibabel.load(phantom / "target.nii.gz")
    affine = image.affine.copy()
    affine[0, 3] += 300
    nibabel.save(nibabel.Nifti1Image(numpy.asarray(image.dataobj), affine), tmp_path / "far.nii.gz")
    finished = run_palpate(
        *recover_arguments(phantom, out, "--align", "none", target=tmp_path / "far.nii.gz"))
    fails_cleanly(finished, out, 4, "overlap")


def test_an_absent_mesher_is_a_mesh_error(phantom, out):
    finished = run_palpate(*recover_arguments(phantom, out),
                           environment={"PALPATE_MESH": "/nowhere/palpate-mesh"})
    fails_cleanly(finished, out, 5, "palpate-mesh")


def test_no_opencl_device_is_a_device_error(phantom, out, tmp_path):
    finished = run_palpate(*recover_arguments(phantom, out),
                           environment={"OCL_ICD_VENDORS": str(tmp_path)})
    fails_cleanly(finished, out, 8, "OpenCL")


def test_an_unknown_device_is_a_device_error(phantom, out):
    finished = run_palpate(*recover_arguments(phantom, out, "--device", "9.9"))
    fails_cleanly(finished, out, 8, "9.9")


def test_an_existing_result_is_kept(phantom, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "mine.txt").write_text("keep")
    finished = run_palpate(*recover_arguments(phantom, out))
    assert finished.returncode == 10
    assert (out / "mine.txt").read_text() == "keep"
    assert str(out) in finished.stderr


def test_a_search_cut_short_is_written_and_flagged(phantom, out):
    finished = run_palpate(*recover_arguments(phantom, out, "--max-iterations", 1))
    assert finished.returncode == 7, finished.stderr
    assert "NOT converge" in finished.stdout
    assert (out / "result.json").exists()
