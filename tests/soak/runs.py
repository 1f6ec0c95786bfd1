# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Runs of palpate that something is done to, and what they may leave behind."""
import concurrent.futures
import dataclasses
import hashlib
import json
import os
import pathlib
import re
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = pathlib.Path(os.environ.get("PALPATE", ROOT / "build/release/bin/palpate"))
BIN = PROGRAM.parent
OPENCL_FAULTS = BIN / "libpalpate_opencl_faults.so"
FILE_FAULTS = BIN / "libpalpate_file_faults.so"

BOX = """
[mesh]
quadratic = {quadratic}
box = {{size_mm = [{size}, {size}, {size}], divisions = [{divisions}, {divisions}, {divisions}]}}
[[material]]
law = "{law}"
stiffness_kpa = {stiffness}
poisson_ratio = {ratio}
[[fix]]
name = "bottom"
where = {{side = "z-min"}}
components = "xyz"
[[move]]
name = "top"
where = {{side = "z-max"}}
z_mm = {pull}
"""


def box_model(size=4, divisions=2, law="neo-hookean", stiffness=10.0, ratio=0.3, pull=1.0,
              quadratic=False):
    """Settings of `palpate simulate` for a cube that is pulled."""
    return BOX.format(size=size, divisions=divisions, law=law, stiffness=stiffness, ratio=ratio,
                      pull=pull, quadratic=str(quadratic).lower())


@dataclasses.dataclass
class Run:
    code: int  # negative: a signal
    stdout: str
    stderr: str
    seconds: float

    def says_one_sentence(self):
        """One line on stderr from palpate, as every failure must give."""
        lines = self.stderr.strip().splitlines()
        return len(lines) == 1 and lines[0].startswith("palpate: ") and len(lines[0]) > 30

    def __str__(self):
        return f"code {self.code}, {self.seconds:.1f} s, said: {self.stderr.strip()[-300:]!r}"


def run(*words, environment=None, limit_s=120, program=None, **more):
    """Runs palpate (or another program); a run beyond the limit is killed and has code -9."""
    begin = time.time()
    process = subprocess.Popen([str(program or PROGRAM), *map(str, words)], text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, errors="replace",
                               env={**os.environ, **(environment or {})}, **more)
    try:
        stdout, stderr = process.communicate(timeout=limit_s)
    except subprocess.TimeoutExpired:
        process.kill()
        stdout, stderr = process.communicate()
        stderr += f"\n(killed after {limit_s} s)"
    return Run(process.returncode, stdout, stderr, time.time() - begin)


def in_parallel(function, cases, workers=2):
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        return list(pool.map(function, cases))


def spread(first, last, count):
    """About `count` whole numbers from `first` to `last`, the ends among them."""
    count = max(2, min(count, last - first + 1))
    return sorted({round(first + k * (last - first) / (count - 1)) for k in range(count)})


def without_times(text):
    """JSON text or a page with all that differs from run to run taken out."""
    def clean(value):
        if isinstance(value, dict):
            return {key: clean(item) for key, item in value.items()
                    if not re.search(r"(_s|seconds|timings|time)$", key)}
        if isinstance(value, list):
            return [clean(item) for item in value]
        if isinstance(value, str):
            return re.sub(r"[0-9.e-]+ s\b", "", value)
        return value
    return json.dumps(clean(json.loads(text)), sort_keys=True)


def contents(folder):
    """What is in a result folder, by name: a hash of the content, less what are times. The page holds
    nothing that the other files do not, and HDF5 notes the time of writing between the numbers: of these
    only completeness is judged."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if not path.is_file():
            continue
        data = path.read_bytes()
        if path.suffix == ".json":
            data = without_times(data.decode()).encode()
        if path.suffix == ".html":
            data = b"whole" if data.rstrip().endswith(b"</html>") else b"cut off"
        if path.suffix == ".h5":
            data = b"%d bytes of %s" % (len(data), data[:8])
        found[str(path.relative_to(folder))] = hashlib.sha256(data).hexdigest()
    return found


class Scene:
    """A small phantom to recover and a box to pull, in a temporary folder; use with `with`."""

    def __enter__(self):
        self._temporary = tempfile.TemporaryDirectory(prefix="palpate-soak-")
        self.folder = pathlib.Path(self._temporary.name)
        (self.folder / "box.toml").write_text(box_model())
        return self

    def __exit__(self, *_):
        self._temporary.cleanup()

    def phantom(self):
        made = self.folder / "phantom"
        if not made.exists():
            finished = run("phantom", "pelvis", "--seed", 2, "--stiffness-kpa", 60, "--spacing", 3, 3,
                           3, "--nodes", 4000, "--out", made, "--quiet")
            assert finished.code == 0, finished
        return made

    def simulate_words(self, out):
        return ["simulate", self.folder / "box.toml", "--out", out, "--quiet"]

    def recover_words(self, out, *more):
        phantom = self.phantom()
        return ["recover", phantom / "reference.nii.gz", phantom / "target.nii.gz", "--config",
                phantom / "organs.toml", "--out", out, "--nodes", 1000, "--quiet", *more]

    def fresh(self):
        """An empty folder."""
        return pathlib.Path(tempfile.mkdtemp(dir=self.folder))
