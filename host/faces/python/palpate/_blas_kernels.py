# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""OpenBLAS that is older than the processor computes with kernels for the oldest one, several times slower: NumPy, whose
OpenBLAS may be the same one, and palpate's library are loaded with OPENBLAS_CORETYPE naming kernels that the processor
can run, if nobody else named any. Too late where NumPy was imported before and has that OpenBLAS."""
import os

CHOICE = "OPENBLAS_CORETYPE"
KERNELS = {"SkylakeX": {"avx512f", "avx512dq", "avx512bw", "avx512vl"}, "Haswell": {"avx2", "fma"}}


def _processor_can() -> set[str]:
    try:
        with open("/proc/cpuinfo", encoding="utf-8", errors="replace") as lines:
            return next((set(line.split()) for line in lines if line.startswith("flags")), set())
    except OSError:
        return set()


def _load() -> None:
    able = _processor_can()
    name = next((name for name, needed in KERNELS.items() if needed <= able), None)
    if name is None or CHOICE in os.environ:
        return
    os.environ[CHOICE] = name
    try:
        import numpy  # noqa: F401

        from . import _core  # noqa: F401
    finally:
        del os.environ[CHOICE]


_load()
