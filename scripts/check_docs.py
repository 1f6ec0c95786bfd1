#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Fails where words of the docs and of the code do not meet.

Comments may cite only sections and equations that docs/method.md has, as "method.md section 4" or
"method.md, 4.1". Types and functions that the glossary and the page on architecture name must exist.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SECTION = re.compile(r"method\.md,? section (\d+)")
NAMING = ("docs/glossary.md", "docs/architecture.md")
EQUATION = re.compile(r"method\.md, (\d+\.\d+)")


def sources():
    for top in ("solver", "host", "kernels", "tests", "bench"):
        for path in sorted((ROOT / top).rglob("*")):
            if path.suffix in (".cpp", ".hpp", ".h", ".cl"):
                yield path


def one_line(text):
    """The text with comments that go on over line ends joined, and the same number of characters."""
    return re.sub(r"\n\s*//+ ?", lambda match: " " * len(match.group()), text)


def citations():
    """(place, "section" or "equation", number) of each citation of method.md."""
    for path in sources():
        text = path.read_text()
        joined = re.sub(r" +", " ", one_line(text))
        for kind, pattern in (("section", SECTION), ("equation", EQUATION)):
            for number in pattern.findall(joined):
                yield path.relative_to(ROOT), kind, number


def wrong_citations():
    method = (ROOT / "docs/method.md").read_text()
    known = {"section": set(re.findall(r"^## (\d+)\.", method, re.MULTILINE)),
             "equation": set(re.findall(r"\((\d+\.\d+)\)", method))}
    for place, kind, number in citations():
        if number not in known[kind]:
            yield f"{place}: docs/method.md has no {kind} {number}"


def unknown_names():
    words = set(re.findall(r"\w+", " ".join(path.read_text() for path in sources())))
    for page in NAMING:
        for name in re.findall(r"`(\w+)(?:\(\))?`", (ROOT / page).read_text()):
            if name not in words:
                yield f"{page}: nothing in the code is called {name}"


def main():
    found = list(wrong_citations()) + list(unknown_names())
    for line in found:
        print(line, file=sys.stderr)
    print("docs: " + (f"{len(found)} citations or names that do not exist" if found else "ok"))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
