# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The short form of each topic of tests/soak that has one; scripts/soak runs the long ones."""
import importlib
import pathlib

import pytest

from tests.soak.figures import table

NO_TOPICS = {"__init__", "figures", "runs"}
TOPICS = sorted({path.stem for path in pathlib.Path(__file__).parent.glob("*.py")} - NO_TOPICS -
                {pathlib.Path(__file__).stem})


@pytest.mark.parametrize("topic", TOPICS)
def test_the_targets_of_a_topic_are_met(topic):
    found = importlib.import_module(f"tests.soak.{topic}").figures(long=False)
    if not found:
        pytest.skip("has a long form only: scripts/soak " + topic)
    missed = [figure for figure in found if not figure.met]
    assert not missed, table(found) + "\n" + "\n".join(figure.detail for figure in missed)
