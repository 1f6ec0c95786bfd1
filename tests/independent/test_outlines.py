# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
import collections

from tests.conftest import PROGRAM
from tests.independent import outlines, silhouettes


def sums_of(kind, tmp_path, settings=outlines.SETTINGS):
    config = tmp_path / "film.toml"
    config.write_text(settings)
    sums = collections.Counter()
    outlines.add_film(kind, 325, PROGRAM, config, sums)
    return sums


def test_a_clear_film_has_no_wrong_point(tmp_path):
    sums = sums_of(silhouettes.SUITE[0], tmp_path)
    assert sums["points"] > 1000 and sums["near"] == sums["points"]
    assert sums["squares"] / sums["near"] < 0.15**2


def test_wrong_points_are_told(tmp_path):
    """A base row that is 5 off makes every point wrong by 5 rows."""
    moved = outlines.SETTINGS.replace(f"base_row_px = {silhouettes.BASE_ROW}", f"base_row_px = {silhouettes.BASE_ROW - 5}")
    sums = sums_of(silhouettes.SUITE[0], tmp_path, moved)
    assert sums["wrong"] > 0.9 * (sums["points"] - sums["flagged"])


def test_a_film_that_is_refused_counts_as_such(tmp_path):
    moved = outlines.SETTINGS.replace(f"base_row_px = {silhouettes.BASE_ROW}", "base_row_px = 60")
    assert sums_of(silhouettes.SUITE[0], tmp_path, moved) == {"refused": 1}
