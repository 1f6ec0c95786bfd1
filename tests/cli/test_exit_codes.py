# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Every documented exit code is reached, with one sentence."""
import os
import re
import resource
import signal
import subprocess

import pytest

from tests.conftest import PROGRAM, ROOT, recover_arguments, run_palpate

def ok(phantom, tmp_path):
    return run_palpate("devices"), None


def internal(phantom, tmp_path):
    """A process without file handles cannot start the mesher: nobody's mistake."""
    few = lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (9, 9))
    arguments = recover_arguments(phantom, tmp_path / "out", "--backend", "reference")
    return subprocess.run([str(PROGRAM), *map(str, arguments)], capture_output=True, text=True,
                          timeout=300, preexec_fn=few), "open files"


def usage(phantom, tmp_path):
    return run_palpate("devices", "--bogus"), "--bogus"


def unreadable(phantom, tmp_path):
    return run_palpate(*recover_arguments(phantom, tmp_path / "out", target="nowhere.nii")), "nowhere.nii"


def unusable(phantom, tmp_path):
    config = tmp_path / "organs.toml"
    config.write_text((phantom / "organs.toml").read_text().replace("label = 1\n", "label = 99\n"))
    return run_palpate(*recover_arguments(phantom, tmp_path / "out", config=config)), "99"


def meshing(phantom, tmp_path):
    return run_palpate(*recover_arguments(phantom, tmp_path / "out"),
                       environment={"PALPATE_MESH": "/nowhere/palpate-mesh"}), "palpate-mesh"


def solving(phantom, tmp_path):
    """Tissue that is softer than numbers can tell has no equilibrium."""
    config = tmp_path / "organs.toml"
    text = (phantom / "organs.toml").read_text()
    config.write_text(re.sub(r"stiffness_kpa = [0-9.]+", "stiffness_kpa = 1e-300", text, count=1))
    return run_palpate(*recover_arguments(phantom, tmp_path / "out", config=config)), "singular"


def not_converged(phantom, tmp_path):
    arguments = recover_arguments(phantom, tmp_path / "out", "--max-iterations", 1)
    return run_palpate(*arguments), None


def device(phantom, tmp_path):
    return run_palpate(*recover_arguments(phantom, tmp_path / "out", "--device", "9.9")), "9.9"


def time_limit(phantom, tmp_path):
    """The mesher sleeps."""
    program = tmp_path / "palpate-mesh"
    program.write_text("#!/bin/sh\nexec sleep 60\n")
    program.chmod(0o755)
    arguments = recover_arguments(phantom, tmp_path / "out", "--mesh-time-limit", 1)
    return run_palpate(*arguments, environment={"PALPATE_MESH": str(program)}), "longer than 1 s"


def cancelled(phantom, tmp_path):
    arguments = [str(a) for a in recover_arguments(phantom, tmp_path / "out") if a != "--quiet"]
    process = subprocess.Popen([str(PROGRAM), *arguments], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True,
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    process.stderr.readline()
    process.send_signal(signal.SIGINT)
    out, text = process.communicate(timeout=60)
    return subprocess.CompletedProcess(arguments, process.returncode, out,
                                       text.strip().splitlines()[-1]), "stopped by a signal"


def output(phantom, tmp_path):
    taken = tmp_path / "taken"
    taken.write_text("mine")
    return run_palpate(*recover_arguments(phantom, taken / "out")), "taken"


TABLE = [(0, ok), (1, internal), (2, usage), (3, unreadable), (4, unusable), (5, meshing),
         (6, solving), (7, not_converged), (8, device), (9, time_limit), (9, cancelled), (10, output)]


@pytest.mark.parametrize("code, reach", TABLE, ids=lambda value: getattr(value, "__name__", value))
def test_is_reached(code, reach, phantom, tmp_path):
    finished, word = reach(phantom, tmp_path)

    assert finished.returncode == code, finished.stderr
    if word is not None:
        lines = finished.stderr.strip().splitlines()
        assert len(lines) == 1 and lines[0].startswith("palpate: ") and word in lines[0], finished.stderr
        assert not (tmp_path / "out").exists()


MIB = 1 << 20


def limit_memory(mib):
    return lambda: resource.setrlimit(resource.RLIMIT_AS, (mib * MIB, mib * MIB))


def test_a_crash_is_told_as_one_where_the_limit_of_memory_is_far(phantom, tmp_path):
    arguments = [str(a) for a in recover_arguments(phantom, tmp_path / "out") if a != "--quiet"]
    process = subprocess.Popen([str(PROGRAM), *arguments], stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True, preexec_fn=limit_memory(200 << 10))
    process.stderr.readline()
    process.send_signal(signal.SIGSEGV)
    text = process.communicate(timeout=60)[1]

    assert process.returncode == -signal.SIGSEGV, text
    assert "limit" not in text


def test_no_temporary_files_are_left_where_memory_is_limited(tmp_path):
    finished = subprocess.run([str(PROGRAM), "devices"], capture_output=True, text=True, timeout=60,
                              preexec_fn=limit_memory(200 << 10), env={**os.environ, "TMPDIR": str(tmp_path)})

    assert finished.returncode == 0, finished.stderr
    assert list(tmp_path.iterdir()) == []


def test_the_table_is_what_is_documented():
    documented = set(map(int, re.findall(r"^\| (\d+) \|", (ROOT / "docs/errors.md").read_text(), re.M)))
    assert documented == set(range(11)) == {code for code, _ in TABLE}
    assert all(f"{code} " in run_palpate("--help").stdout for code in documented)
