#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Fails on any #include that points against the direction of data flow, and on any that goes in a circle.

A file may include its own folder and the folders listed for it, which are written below in the order
of the layers. See CONTRIBUTING.md for the picture. A unit (a header with the source of the same name)
may not include, through whatever others, itself. Nor may two headers define types of one name.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

SOLVER_MODEL = ["solver/base", "solver/mesh", "solver/elements", "solver/materials", "solver/model"]
BACKEND = SOLVER_MODEL + ["solver/backend"]
SOLVER = BACKEND + ["solver/linear", "solver/equilibrium", "solver/adjoint", "solver/sensitivity",
                    "solver/condense"]
FILES = SOLVER + ["host/system", "host/io"]
GEOMETRY = FILES + ["host/geometry/fields", "host/geometry/surfaces", "host/geometry/meshing", "host/geometry/warping"]
PAGES = GEOMETRY + ["host/page"]
APPLICATION = PAGES + ["host/estimate", "host/apps/application"]
COMPUTING = APPLICATION + ["host/apps/compute_options"]
APPLICATIONS = ["recover/run", "simulate", "identify", "springs", "phantom", "study", "aspirate"]
FACES = ["host/apps/application", "host/apps/describe", "host/apps/all"]
RECOVER = [f"host/apps/recover/{station}"
           for station in ("modelling", "observations", "inverse", "result", "report", "pipeline")]

ALLOWED = {
    "solver/base": [],
    "solver/mesh": ["solver/base"],
    "solver/elements": ["solver/base"],
    "solver/materials": ["solver/base"],
    "solver/model": SOLVER_MODEL,
    "solver/backend": SOLVER_MODEL,
    "solver/backends": BACKEND + ["solver/backends/reference", "solver/backends/opencl",
                                   "solver/backends/kokkos"],
    "solver/backends/reference": BACKEND,
    "solver/backends/opencl": BACKEND,
    "solver/backends/kokkos": BACKEND,
    "solver/linear": BACKEND,
    "solver/equilibrium": BACKEND + ["solver/linear"],
    "solver/adjoint": BACKEND + ["solver/linear", "solver/equilibrium"],
    "solver/sensitivity": BACKEND + ["solver/linear", "solver/equilibrium"],
    "solver/condense": BACKEND + ["solver/linear", "solver/equilibrium"],
    # The mesh program is licensed apart: it shares the exchange format and plain types, no more.
    "host/geometry/mesh_tool": ["solver/base", "solver/mesh", "host/geometry/meshing/exchange",
                                "host/geometry/meshing/dihedral"],
    "host/system": SOLVER,
    "host/io": FILES,
    # A figure of a result carries its verdict, and all results tell alike who solved; no more.
    "host/page": ["solver/base", "host/estimate/verdict", "solver/linear/linear_solver",
                  "solver/equilibrium/element_loops"],
    "host/estimate": ["solver/base"],
    # An application is a folder that knows the table; the list of all of them knows each.
    "host/apps/application": PAGES,
    "host/apps/describe": PAGES + ["host/apps/application"],
    "host/apps/compute_options": GEOMETRY,
    "host/apps/all": APPLICATION + [f"host/apps/{name}" for name in APPLICATIONS],
    "host/apps/springs": APPLICATION,
    "host/apps/phantom": COMPUTING + RECOVER[:1] + ["host/apps/phantom/random_numbers", "host/apps/phantom/aspiration"],
    # Drawn from a seed, for phantoms of any kind.
    "host/apps/phantom/random_numbers": ["solver/base"],
    # Films of sucked tissue.
    "host/apps/phantom/aspiration": COMPUTING + ["host/apps/phantom/random_numbers", "host/apps/aspirate/contours",
                                                 "host/apps/aspirate/model", "host/apps/simulate"],
    # Outlines of tissue in frames are found without files, settings and pages.
    "host/apps/aspirate/contours": ["solver/base"],
    # Frames, one after the other, from files, films and pipes.
    "host/apps/aspirate/frames": FILES + ["host/apps/aspirate/contours"],
    # What is known before any frame, and the body that is sucked, as the text of a model file.
    "host/apps/aspirate/model": FILES + ["host/apps/aspirate/contours", "host/apps/simulate"],
    "host/apps/aspirate": COMPUTING + ["host/apps/aspirate/contours", "host/apps/aspirate/frames",
                                       "host/apps/aspirate/model", "host/apps/simulate", "host/apps/identify"],
    "host/apps/study": COMPUTING + RECOVER + ["host/apps/phantom", "host/apps/phantom/random_numbers", "host/apps/phantom/aspiration",
                                             "host/apps/aspirate/contours", "host/apps/aspirate/model", "host/apps/identify"],
    "host/apps/simulate": COMPUTING,
    # An experiment is a simulation with unknown numbers.
    "host/apps/identify": COMPUTING + ["host/apps/simulate"],
    "host/apps/recover/run": COMPUTING + RECOVER,
    "host/apps/export": PAGES + RECOVER[:5],
    "host/cohort": COMPUTING + RECOVER + ["host/apps/recover/run"],
    "host/faces/cli": PAGES + FACES + ["host/apps/export", "host/cohort"],
    "host/faces/slicer": PAGES + RECOVER + ["host/apps/recover/run"],
    "host/faces/python": ["host/faces/capi"],
    "host/faces/capi": PAGES + FACES + RECOVER + ["host/apps/phantom", "host/apps/aspirate"],
}
for position, folder in enumerate(GEOMETRY):
    if folder.startswith("host/geometry"):
        ALLOWED[folder] = GEOMETRY[:position]
for position, station in enumerate(RECOVER):
    ALLOWED[station] = PAGES + ["host/estimate"] + RECOVER[:position]

INCLUDE = re.compile(r'^\s*#\s*include\s+"((?:solver|host|kernels|tests)/[^"]+)"')


def folder_of(path):
    """The layer that a file belongs to: the unit itself or the longest folder with a rule."""
    parent = path.with_suffix("")
    while str(parent) not in ALLOWED and parent != parent.parent:
        parent = parent.parent
    return str(parent)


def is_allowed(source, included):
    layer = folder_of(source)
    if folder_of(included) == layer:
        return True
    name = str(included.with_suffix(""))
    return any(rule in (folder_of(included), str(included.parent), name) for rule in ALLOWED[layer])


def violations():
    for top in ("solver", "host"):
        for path in sorted((ROOT / top).rglob("*")):
            if path.suffix not in (".cpp", ".hpp", ".h"):
                continue
            source = path.relative_to(ROOT)
            if folder_of(source) == ".":
                yield f"{source}: no rule for its folder in scripts/check_layers.py"
                continue
            for number, line in enumerate(path.read_text().splitlines(), start=1):
                match = INCLUDE.match(line)
                if match and not is_allowed(source, pathlib.Path(match.group(1))):
                    yield f"{source}:{number}: {folder_of(source)} may not include {match.group(1)}"


def included_units():
    """{unit: units that its header or source includes}, each a path without its ending."""
    units = {}
    for top in ("solver", "host"):
        for path in sorted((ROOT / top).rglob("*")):
            if path.suffix not in (".cpp", ".hpp", ".h"):
                continue
            unit = path.relative_to(ROOT).with_suffix("")
            matches = map(INCLUDE.match, path.read_text().splitlines())
            included = {pathlib.Path(match.group(1)).with_suffix("") for match in matches if match}
            units.setdefault(unit, set()).update(included - {unit})
    return units


def circles():
    """One sentence for each set of units that include each other: depth first, a unit met again while open."""
    units, done, told = included_units(), set(), set()

    def walk(unit, way):
        if unit in way:
            circle = way[way.index(unit):]
            if frozenset(circle) not in told:
                told.add(frozenset(circle))
                yield "circle of includes: " + " -> ".join(map(str, [*circle, unit]))
            return
        if unit in done:
            return
        for included in sorted(units.get(unit, ())):
            yield from walk(included, [*way, unit])
        done.add(unit)

    for unit in units:
        yield from walk(unit, [])


TYPE = re.compile(r"^(?:struct|class|enum class)\s+(\w+)\b[^;{]*\{", re.MULTILINE)
NAMESPACE = re.compile(r"^namespace ([\w:]+) \{", re.MULTILINE)
OTHER_PROGRAMS = ("host/geometry/mesh_tool",)


def types_with_one_name():
    """Types of one name that two headers define in one name space: the linker takes either, without a word."""
    places = {}
    for top in ("solver", "host"):
        for path in sorted((ROOT / top).rglob("*.hpp")):
            source = path.relative_to(ROOT)
            if str(source.parent) in OTHER_PROGRAMS:
                continue
            text = path.read_text()
            space = NAMESPACE.search(text)
            for match in TYPE.finditer(text):
                places.setdefault((space.group(1) if space else "", match.group(1)), []).append(str(source))
    for (space, name), sources in places.items():
        if len(set(sources)) > 1:
            yield f"{space}::{name} is defined in {' and in '.join(sorted(set(sources)))}"


def main():
    found = list(violations()) + list(circles()) + list(types_with_one_name())
    for line in found:
        print(line, file=sys.stderr)
    print("layers: " + (f"{len(found)} includes against the flow or in a circle, or types of one name" if found else "ok"))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
