#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""R30: the tests under sanitizers (address, undefined behaviour, threads), and every kernel under oclgrind.
Has only a long form: it builds everything twice, in build/sanitize and build/sanitize-thread."""
import json
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent))
from tests.soak.figures import Figure, main  # noqa: E402
from tests.soak.runs import BIN, OPENCL_FAULTS, ROOT, Scene, run  # noqa: E402

# Those whose code starts threads of its own.
THREADED = ["solver_test", "inverse_test", "linear_solver_contract_test", "solid_contract_test",
            "equilibrium_contract_test", "handles_client"]
REPORT = re.compile(r"(ERROR: \w+Sanitizer|WARNING: ThreadSanitizer|runtime error:)")
HERE = pathlib.Path(__file__).resolve().parent


def options(reports):
    """Environment of a suite whose reports go to files that begin with this path: children that read
    files are silent, and what they print is taken for a complaint about the file."""
    log = f"log_path={reports}"
    return {
        # Libraries keep what they made until the process ends.
        "LSAN_OPTIONS": f"suppressions={HERE / 'leak_suppressions.txt'}",
        # A size from a damaged file: without sanitizers the child's limit of memory refuses it.
        "ASAN_OPTIONS": f"allocator_may_return_null=1:{log}",
        "UBSAN_OPTIONS": f"print_stacktrace=1:{log}",
        # Libraries that were not built for it are not looked into.
        "TSAN_OPTIONS": f"ignore_noninstrumented_modules=1:{log}:"
                        f"suppressions={HERE / 'thread_suppressions.txt'}",
        "OPENBLAS_NUM_THREADS": "1",
    }


def is_of_a_library(text):
    """A crash inside TetGen or a reader of VTK, of a child that is there to be ended by it: tests of
    surfaces and files that are damaged are made for that."""
    frames = re.findall(r"^ +#[01] .*", text, re.M)[:2]
    return "ERROR: AddressSanitizer" in text and any(re.search("libtet|libvtkIO", frame) for frame in frames)


def commands_of(preset, programs):
    """What ctest runs of this build, by name: each of its programs once, with all its cases. Those
    that are Python, or test a build and not its code, are left out."""
    listed = subprocess.run(["ctest", "--show-only=json-v1"], cwd=programs.parent, check=True,
                            capture_output=True, text=True)
    commands = {}
    for test in json.loads(listed.stdout)["tests"]:
        program, *words = test.get("command", [""])
        if pathlib.Path(program).parent == programs:
            commands[pathlib.Path(program).name] = [
                program, *(word for word in words if not word.startswith("--gtest_"))]
    assert commands, f"ctest lists no test of {preset}"
    return commands


def under(preset, chosen=None):
    """All tests of this preset, or those chosen."""
    subprocess.run(["cmake", "--preset", preset], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["nice", "cmake", "--build", "--preset", preset, "--target",
                    *(chosen or ["all"]), "palpate-mesh"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    commands = commands_of(preset, ROOT / "build" / preset / "bin")
    suites = chosen or sorted(commands)
    reports, failed = [], []
    with Scene() as scene:
        for suite in suites:
            program, *words = commands[suite]
            finished = run(*words, program=program, environment=options(scene.folder / suite),
                           limit_s=7200, cwd=ROOT)
            texts = [path.read_text(errors="replace") for path in scene.folder.glob(f"{suite}.*")]
            text = "\n".join(text for text in texts if not is_of_a_library(text))
            found = [f"{suite}: {line}" for line in text.splitlines() if REPORT.search(line)]
            print(f"{preset} {suite}: code {finished.code}, {finished.seconds:.0f} s, {len(found)} reports",
                  file=sys.stderr, flush=True)
            reports += found
            if found:
                print(text[:8000], file=sys.stderr, flush=True)
            if finished.code != 0:
                failed.append(f"{suite}: code {finished.code} " + " ".join(
                    re.findall(r"\[  FAILED  \] (\S+)", finished.stdout)[:5]))
    return [Figure("R30", f"{preset}: reports of {len(suites)} suites", str(len(reports)), "0",
                   not reports, "\n".join(reports[:20])),
            Figure("R30", f"{preset}: suites that fail", str(len(failed)), "0", not failed,
                   "\n".join(failed))]


def kernels_of_the_source():
    names = set()
    for path in (ROOT / "kernels").rglob("*.cl"):
        names |= set(re.findall(r"PALPATE_KERNEL\s+void\s+(\w+)\s*\(", path.read_text()))
    return names


def kernels_of_the_check():
    """Those that the tests launch which scripts/check_kernels runs."""
    values = dict(re.findall(r'^(cases|tests|vectors)="(.*)"', (ROOT / "scripts/check_kernels").read_text(),
                             re.M))
    tests = values["tests"].replace("$cases", values["cases"])
    with Scene() as scene:
        names = scene.folder / "kernels"
        for suite, chosen in (("unit_opencl_test", tests), ("backend_contract_test", values["vectors"])):
            run(f"--gtest_filter={chosen}", program=BIN / suite, limit_s=1800, cwd=ROOT,
                environment={"OPENCL_LAYERS": str(OPENCL_FAULTS),
                             "PALPATE_FAULT_KERNELS": str(names)})
        return set(names.read_text().split())


def oclgrind():
    source, launched = kernels_of_the_source(), kernels_of_the_check()
    missing = sorted(source - launched)
    finished = run(program=ROOT / "scripts/check_kernels", limit_s=3600)
    return [Figure("R30", "kernels that oclgrind runs", f"{len(source & launched)} of {len(source)}",
                   "all", not missing, ", ".join(missing)),
            Figure("R30", "oclgrind", "clean" if finished.code == 0 else "reports", "clean",
                   finished.code == 0, finished.stderr[-2000:] if finished.code else "")]


def figures(long):
    if not long:
        return []
    return oclgrind() + under("sanitize") + under("sanitize-thread", THREADED)


if __name__ == "__main__":
    main(figures)
