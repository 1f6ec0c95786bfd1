# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""palpate.contours and palpate.ContourTracker: the rows of `palpate aspirate contours`, from arrays."""
import io

import numpy as np
import pytest

from tests.cli.test_aspirate import SETTINGS, from_pipe
from tests.independent import silhouettes

palpate = pytest.importorskip("palpate", reason="the Python package is not installed: pip install .")

NUM_FRAMES = 14


@pytest.fixture(scope="module")
def frames():
    return np.array([frame for frame, _ in silhouettes.film(silhouettes.SUITE[0], 5, NUM_FRAMES)])


@pytest.mark.parametrize("settings", [SETTINGS, SETTINGS.replace("axis_column_px = 89.5\n", ""),
                                      SETTINGS.replace("[frames]", "crop_px = [4, 0, 172, 180]\n[frames]"),
                                      SETTINGS + 'method = "published"\n'],
                         ids=["axis", "no axis", "crop", "published"])
def test_arrays_give_the_rows_of_the_command_line(settings, frames, tmp_path):
    path = tmp_path / "aspiration.toml"
    path.write_text(settings)
    finished = from_pipe(path, frames)
    assert finished.returncode == 0, finished.stderr
    rows = np.loadtxt(io.BytesIO(finished.stdout), delimiter=",", skiprows=1, comments="#")
    rows = rows.reshape(NUM_FRAMES, -1, 5)
    found = palpate.contours(frames, path)
    assert found.z_mm.shape == rows.shape[:2]
    assert found.r_mm == pytest.approx(rows[0, :, 1], abs=1e-4)
    assert found.z_mm == pytest.approx(rows[:, :, 2], abs=1e-5)
    assert found.sd_mm == pytest.approx(rows[:, :, 3], abs=1e-5)
    assert np.array_equal(found.flag, rows[:, :, 4])
    assert found.axis_column_px == pytest.approx(89.5, abs=0.5)


def test_a_camera_is_followed_frame_by_frame(frames):
    tracker = palpate.ContourTracker(SETTINGS, width=180, height=180)
    film = palpate.contours(iter(frames), SETTINGS)
    for number, frame in enumerate(frames):
        profile = tracker.add(frame)
        assert np.array_equal(profile.z_mm[tracker.is_within], film.z_mm[number])
    assert tracker.axis_column_px == 89.5 and len(tracker.r_mm) == 180


def test_other_depths_of_grey_say_the_same(frames):
    bytes_alone = palpate.contours(frames, SETTINGS)
    words = palpate.contours(frames.astype(np.uint16) * 257, SETTINGS)
    assert words.z_mm == pytest.approx(bytes_alone.z_mm, abs=1e-4)
    small_words = palpate.contours(frames.astype(np.uint16), SETTINGS, white=255)
    assert np.array_equal(small_words.z_mm, bytes_alone.z_mm)
    twelve_bits = palpate.contours(frames.astype(np.uint16) * 16, SETTINGS, white=4080)
    assert twelve_bits.z_mm == pytest.approx(bytes_alone.z_mm, abs=1e-4)


def test_what_cannot_be_is_refused(frames):
    with pytest.raises(palpate.PalpateError, match="base_row_px") as refused:
        palpate.ContourTracker(SETTINGS, width=180, height=100)
    assert refused.value.status == 4
    with pytest.raises(palpate.PalpateError, match="hole"):
        palpate.ContourTracker("[instrument]\nhole = 1\n", width=180, height=180)
    with pytest.raises(FileNotFoundError):
        palpate.ContourTracker("nothing.toml", width=180, height=180)
    tracker = palpate.ContourTracker(SETTINGS, width=180, height=180)
    with pytest.raises(palpate.PalpateError, match="height and width"):
        tracker.add(frames[0][:, :90])
    with pytest.raises(TypeError, match="float64"):
        tracker.add(frames[0].astype(float))
    with pytest.raises(TypeError):
        tracker.add(frames)
    with pytest.raises(ValueError, match="at least one"):
        palpate.contours([], SETTINGS)
    assert len(tracker.add(frames[0]).z_mm) == 180  # it goes on


def test_an_identification_has_a_name_of_its_own():
    assert palpate.identify is palpate.applications.identify
