# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The Boutiques descriptor says what the program says."""
import json
import pathlib
import re
import shutil
import subprocess
import sys

import pytest

from tests.conftest import PROGRAM, ROOT, run_palpate

DESCRIPTOR = ROOT / "host/faces/cli/palpate.boutiques.json"
BOSH = shutil.which("bosh") or shutil.which("bosh", path=pathlib.Path(sys.executable).parent)


@pytest.fixture(scope="module")
def descriptor():
    return json.loads(DESCRIPTOR.read_text())


def test_it_is_what_the_program_describes():
    assert run_palpate("describe", "recover", "--as", "boutiques").stdout == DESCRIPTOR.read_text(), (
        f"make it again: palpate describe recover --as boutiques > {DESCRIPTOR.relative_to(ROOT)}")


def test_its_exit_codes_are_those_of_the_program(descriptor):
    told = run_palpate("--help").stdout
    footer = " ".join(told[told.index("Exit codes:"):].split())
    codes = dict(re.findall(r"(\d+) ([a-z][a-z ()]*)", footer))
    codes.pop("0")
    assert {str(e["code"]): e["description"] for e in descriptor["error-codes"]} == codes


def test_its_version_is_that_of_the_program(descriptor):
    assert f"palpate {descriptor['tool-version']}" == run_palpate("--version").stdout.splitlines()[0]


@pytest.mark.skipif(not BOSH, reason="Boutiques is not installed: scripts/python installs it")
def test_it_is_valid_and_builds_the_command_line(phantom, tmp_path):
    subprocess.run([BOSH, "validate", DESCRIPTOR], check=True, capture_output=True)
    invocation = tmp_path / "invocation.json"
    invocation.write_text(json.dumps({
        "reference": str(phantom / "reference.nii.gz"), "target": [str(phantom / "target.nii.gz")],
        "config": str(phantom / "organs.toml"), "out": str(tmp_path / "result"), "nodes": 1500}))
    told = subprocess.run([BOSH, "exec", "simulate", DESCRIPTOR, "-i", invocation],
                          capture_output=True, text=True, check=True).stdout
    (line,) = [line for line in told.splitlines() if line.startswith("palpate recover ")]
    finished = subprocess.run([str(PROGRAM), *line.split()[1:]], capture_output=True, text=True)
    assert finished.returncode == 0, finished.stderr
    assert (tmp_path / "result/result.json").exists()
