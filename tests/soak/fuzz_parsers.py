#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""R12: every parser of palpate under libFuzzer with the address and undefined-behaviour sanitizers,
ten million runs or ten minutes each (PALPATE_FUZZ_SECONDS), from seeds that are made here; all, or those of
PALPATE_FUZZ_PARSERS. Builds them first."""
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent))
from tests import hard_images  # noqa: E402
from tests.soak.figures import Figure, main  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SECONDS = int(os.environ.get("PALPATE_FUZZ_SECONDS", 600))
PARSERS = ["nifti", "nrrd", "meta", "settings", "simulation", "load_table", "point_text", "point_table", "study_rows",
           "saved_reference", "program_entry", "number_table", "pgm", "aspiration"]


ASPIRATION = """[instrument]
hole_diameter_mm = 5.0
edge_radius_mm = 0.2
rim_thickness_mm = 0.5
outer_diameter_mm = 20.0
pixel_r_um = 62.9
pixel_z_um = 31.75
base_row_px = 150
axis_column_px = 89.5
crop_px = [0, 0, 180, 180]
tissue = "brighter"
[frames]
rate_hz = 25.0
method = "published"
[pressure]
delay_s = {value = 0.0, sd = 0.02}
time_s = [0, 1, 2]
suction_mbar = [0, 50, 0]
[tissue]
depth_mm = 16.0
laws = ["veronda-westmann", "reduced-polynomial"]
relaxation_terms = [0, 1]
kappa_over_young = 500
friction = "unknown"
steps = 32
[supposed]
mu_kpa = 0.7
gamma = 10
"""


def cases(*endings):
    return [data for case in [*hard_images.refused(), *hard_images.accepted()]
            for name, data in case.files.items() if name.lower().endswith(endings) and len(data) < 8000]


def texts(*patterns):
    return [path.read_bytes() for pattern in patterns for path in sorted(ROOT.glob(pattern))]


def seeds(parser):
    """Small files of the kind that the parser takes."""
    if parser in ("nifti", "nrrd", "meta"):
        return cases(*{"nifti": (".nii", ".nii.gz"), "nrrd": (".nrrd", ".nhdr"), "meta": (".mha", ".mhd")}[parser])
    return {
        "settings": lambda: texts("examples/*/*.toml") + [b"[prior]\nnoise_voxels = 0.25\npoisson_lowest = 0.3\n"],
        "simulation": lambda: texts("examples/simulate/*.toml"),
        "load_table": lambda: texts("examples/simulate/*.csv") + [b"time_s,depth\n0,0\n1,0.5\n2,1\n"],
        "point_text": lambda: [b"x,y,z\n1,2,3\n4 5 6\n# no\n7;8;9\n-1e3\t+2.5 0\r\n" * 3],
        "point_table": lambda: [b'# a\nname,x,y,z\n"a, b",1,2,3\nc,4,5,6\n', b"1,2,3\n4;5;6\n"],
        "program_entry": lambda: [b"palpate program1" + struct.pack("<QQQ", 20, 3, 0) +
                                  b"the key of a program" + b"\1\2\3"],
        "study_rows": lambda: [b'case,"a, b",c\r\n1,"say ""so""",x\n2,,\n'],
        "number_table": lambda: texts("examples/identify/*.csv") + [b"time_s,r_mm,z_mm,sd_mm,flag\n0,-1,0.5,0.01,0\n"],
        "pgm": lambda: [b"P5\n3 2\n255\nabcdef", b"P5 # a\n1 2\n4095\nabcd"],
        "aspiration": lambda: [ASPIRATION.encode(), ASPIRATION.replace("= 5.0", "= {value = 5.0, sd = 0.1}").encode()],
        "saved_reference": lambda: [struct.pack("<Q", 5) + b"0.1.0" + bytes(400), bytes(2000)],
    }[parser]()


def words(parser):
    """A dictionary for text: names of keys are hard to guess."""
    if parser not in ("nrrd", "meta", "settings", "simulation", "aspiration"):
        return []
    found = set()
    for data in seeds(parser):
        found.update(re.findall(rb"[A-Za-z_][A-Za-z_ -]{2,30}", data))
    return sorted(found)[:400]


def fuzz(parser, folder):
    corpus = folder / parser
    corpus.mkdir()
    for k, data in enumerate(seeds(parser)):
        (corpus / f"seed{k}").write_bytes(data)
    dictionary = folder / f"{parser}.words"
    dictionary.write_bytes(b"".join(b'"%s"\n' % word for word in words(parser)) or b"# none\n")
    finished = subprocess.run(
        [ROOT / "build/fuzz/bin" / f"fuzz_{parser}", f"-max_total_time={SECONDS}", "-runs=10000000", "-max_len=16384",
         "-timeout=10", "-rss_limit_mb=2048", "-print_final_stats=1", f"-dict={dictionary}",
         f"-artifact_prefix={folder}/{parser}-", corpus],
        capture_output=True, text=True, errors="replace", check=False)
    done = re.search(r"number_of_executed_units:\s*(\d+)", finished.stderr)
    executions = int(done.group(1)) if done else 0
    finding = "" if finished.returncode == 0 else finished.stderr[-4000:]
    for path in folder.glob(f"{parser}-*"):
        finding += f"\ninput: {path.read_bytes()[:2000]!r}"
    return Figure("R12", f"{parser}: runs, {SECONDS} s at most", f"{executions:,}", "no finding", not finding, finding)


def figures(long):
    if not long:
        return []
    for command in (["--preset", "fuzz"], ["--build", "--preset", "fuzz"]):
        subprocess.run(["cmake", *command], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    with tempfile.TemporaryDirectory(prefix="palpate-soak-") as folder:
        wanted = os.environ.get("PALPATE_FUZZ_PARSERS", " ".join(PARSERS)).split()
        return [fuzz(parser, pathlib.Path(folder)) for parser in wanted]


if __name__ == "__main__":
    main(figures)
