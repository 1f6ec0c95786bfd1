#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Times one recovery by the command line, through C and through Python, in turn.

  build/venv/bin/python scripts/compare_calls.py [--rounds 7] [--build build/release]

Whole processes: start, reading two label volumes, recovering, writing the result folder; and of the
Python process also the call alone, without the start of the interpreter and of NumPy. The same phantom
each time, warmed up once. Prints the median of each and the median over rounds of its ratio to the
command line in the same round.
"""
import argparse
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

PYTHON = """
import sys, time, palpate
begin = time.perf_counter()
palpate.recover(*sys.argv[1:4]).write(sys.argv[4])
print(time.perf_counter() - begin)
"""


def seconds_of(command):
    """(of the whole process, what it printed)"""
    begin = time.perf_counter()
    finished = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    if finished.returncode != 0:
        sys.exit(f"{command[0]}: {finished.stderr}")
    return time.perf_counter() - begin, finished.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--build", type=pathlib.Path, default=pathlib.Path("build/release"))
    arguments = parser.parse_args()
    programs = arguments.build / "bin"
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        phantom = folder / "phantom"
        seconds_of([programs / "palpate", "phantom", "pelvis", "--seed", 3, "--out", phantom])
        images = [phantom / "reference.nii.gz", phantom / "target.nii.gz"]
        settings = phantom / "organs.toml"
        callers = {
            "command line": lambda out: [programs / "palpate", "recover", *images, "--config",
                                         settings, "--out", out, "--quiet"],
            "C": lambda out: [programs / "recover_once", *images, settings, out],
            "Python": lambda out: [sys.executable, "-c", PYTHON, *images, settings, out],
        }
        times = {caller: [] for caller in (*callers, "Python, call")}
        for k in range(arguments.rounds + 1):
            for caller, command in callers.items():
                seconds, printed = seconds_of(command(folder / f"{caller} {k}"))
                times[caller].append(seconds)
                if caller == "Python":
                    times["Python, call"].append(float(printed))
            print(f"round {k}: " + ", ".join(f"{caller} {t[-1]:.2f} s"
                                             for caller, t in times.items()), flush=True)
        for caller, measured in times.items():
            ratios = [a / b for a, b in zip(measured[1:], times["command line"][1:])]
            print(f"{caller:<13} median {statistics.median(measured[1:]):6.2f} s, "
                  f"{statistics.median(ratios):.3f} of the command line")


if __name__ == "__main__":
    main()
