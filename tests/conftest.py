# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
import contextlib
import os
import pathlib
import subprocess

with contextlib.suppress(ImportError):
    # Before anything imports NumPy: OpenBLAS has its kernels from whoever loads it first, and the package and the
    # program give the same meshes and results with the same kernels only.
    import palpate  # noqa: F401

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = pathlib.Path(os.environ.get("PALPATE", ROOT / "build/release/bin/palpate"))
DATA = pathlib.Path(os.environ.get("PALPATE_DATA", ROOT / "../shared/data"))


def run_palpate(*arguments, environment=None):
    """Runs the program; returns the finished process with its text."""
    return subprocess.run([str(PROGRAM), *map(str, arguments)], capture_output=True, text=True,
                          timeout=900, env={**os.environ, **(environment or {})})


@pytest.fixture(scope="session")
def phantom(tmp_path_factory):
    """A small, coarse pelvis phantom of 60 kPa: for the command line, not for accuracy."""
    folder = tmp_path_factory.mktemp("input") / "phantom"
    finished = run_palpate("phantom", "pelvis", "--seed", 2, "--stiffness-kpa", 60, "--spacing", 2, 2,
                           2, "--nodes", 8000, "--out", folder, "--quiet")
    assert finished.returncode == 0, finished.stderr
    return folder


def recover_arguments(phantom, out, *more, reference=None, target=None, config=None):
    return ["recover", reference or phantom / "reference.nii.gz",
            target or phantom / "target.nii.gz", "--config", config or phantom / "organs.toml",
            "--out", out, "--nodes", 2500, "--quiet", *more]


def with_unknown_ratio(phantom, folder):
    """The phantom's settings with the prostate's Poisson's ratio unknown; the file."""
    config = folder / "unknown_ratio.toml"
    before, prostate = (phantom / "organs.toml").read_text().split('stiffness_kpa = "unknown"', 1)
    ratio = prostate.strip().splitlines()[0]
    assert ratio.startswith("poisson_ratio = ")
    config.write_text(before + 'stiffness_kpa = "unknown"' +
                      prostate.replace(ratio, 'poisson_ratio = "unknown"', 1))
    return config
