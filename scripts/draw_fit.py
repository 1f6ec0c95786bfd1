#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/identify.svg: the picture that the report of examples/identify/strip.toml has.

    scripts/draw_fit.py [--palpate build/release/bin/palpate]
"""
import argparse
import pathlib
import re
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
STYLE = """.ring{fill:#fff;stroke-width:1.6}.bar{stroke-width:1.4;opacity:.6}.axis{stroke:#666;fill:none}.grid{stroke:#ddd;fill:none}.curve{fill:none;stroke-width:2}
text{font:12px sans-serif;fill:#555}"""


def alone(svg):
    """A picture of a page as a file of its own, on white paper."""
    view = re.search(r"viewBox='([^']+)'", svg)[1]
    body = svg[svg.index(">") + 1:svg.rindex("</svg>")]
    width, height = view.split()[2:]
    return (f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='{view}'>\n"
            "<!-- SPDX-FileCopyrightText: The palpate developers -->\n<!-- SPDX-License-Identifier: Apache-2.0 -->\n"
            "<!-- Made by scripts/draw_fit.py -->\n"
            f"<style>{STYLE}</style><rect width='{width}' height='{height}' fill='#fff'/>\n{body}\n</svg>\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--palpate", default=ROOT / "build/release/bin/palpate", type=pathlib.Path)
    palpate = parser.parse_args().palpate
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "result"
        if not palpate.is_file():
            raise SystemExit(f"there is no program {palpate}; build it first (scripts/build release)")
        run = subprocess.run([palpate, "identify", ROOT / "examples/identify/strip.toml", "--out", out, "--quiet"],
                             stdout=subprocess.DEVNULL)
        if run.returncode != 0:
            raise SystemExit(f"{palpate} identify ended with code {run.returncode}")
        page = (out / "report.html").read_text(encoding="utf-8")
    picture = re.search(r"<svg class='plot'.*?</svg>", page, re.S)
    if not picture:
        raise SystemExit(f"the report of {palpate} has no picture; is it an older build?")
    (ROOT / "docs/identify.svg").write_text(alone(picture[0]), encoding="utf-8")


if __name__ == "__main__":
    main()
