# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""OpenBLAS that does not know the processor is told which kernels it can run."""
import os
import pathlib
import re
import subprocess
import sys

import pytest

from tests.conftest import PROGRAM


def flags_of_the_processor():
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return set()
    return next((set(line.split()) for line in lines if line.startswith("flags")), set())


def cores_named(command, **choice):
    """What OpenBLAS says each time that it is loaded."""
    environment = {name: value for name, value in os.environ.items() if name != "OPENBLAS_CORETYPE"}
    ran = subprocess.run(command, capture_output=True, text=True, check=True,
                         env={**environment, "OPENBLAS_VERBOSE": "2", **choice})
    cores = re.findall(r"^Core: (\w+)$", ran.stdout + ran.stderr, re.MULTILINE)
    if not cores:
        pytest.skip("this BLAS is not an OpenBLAS that tells its kernels")
    return cores


needs_avx2 = pytest.mark.skipif(not {"avx2", "fma"} <= flags_of_the_processor(), reason="this processor has no AVX2")


@needs_avx2
def test_program_computes_with_kernels_of_the_processor():
    assert cores_named([PROGRAM, "--version"])[-1] != "Prescott"


@needs_avx2
def test_python_library_computes_with_kernels_of_the_processor():
    script = "import palpate, os; assert 'OPENBLAS_CORETYPE' not in os.environ"
    assert cores_named([sys.executable, "-c", script])[-1] != "Prescott"


def test_what_the_user_chose_stays():
    assert cores_named([PROGRAM, "--version"], OPENBLAS_CORETYPE="Prescott") == ["Prescott"]
