#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/house.svg and the arrows of docs/architecture.md from the table of check_layers.py.

    scripts/draw_house.py           writes both
    scripts/draw_house.py --check   fails if they are not what the table says

A room may include what its arrow points at and what that may include in turn; the table of the page
says what of that it may not. Rooms without a place in ROWS stand at the end of their row.
"""
import html
import pathlib
import sys

from check_layers import ALLOWED, ROOT

PICTURE = ROOT / "docs/house.svg"
PAGE = ROOT / "docs/architecture.md"
BEGIN, END = "<!-- arrows: scripts/draw_house.py -->\n", "<!-- end of arrows -->\n"

# What stands in a row, from left to right; a name that ends in / takes all rooms of that folder that
# no other row takes, and an empty one leaves a place free for arrows.
ROWS = [
    ("host/faces", ["host/faces/capi", "host/faces/python", "host/faces/cli", "host/faces/", "", "host/faces/slicer"]),
    ("host/cohort", ["host/cohort"]),
    ("host/apps", ["host/apps/phantom", "host/apps/export", "host/apps/simulate", "host/apps/study", "host/apps/", ""]),
    ("host/apps/recover", [f"host/apps/recover/{name}" for name in
                           ("modelling", "observations", "inverse", "result", "report", "pipeline")]),
    ("host", ["host/estimate", "host/page"]
     + [f"host/geometry/{name}" for name in ("fields", "surfaces", "meshing", "warping", "mesh_tool")]),
    ("host", ["", "", "", "", "host/system", "host/io", "host/"]),
    ("solver", ["solver/base", "solver/mesh", "solver/elements", "solver/materials", "solver/model",
                "solver/backend", "solver/linear", "solver/equilibrium", "solver/condense", "solver/"]),
    ("solver/backends", ["", "", "solver/backends/reference", "solver/backends/opencl", "solver/backends/kokkos",
                         "solver/backends"]),
]


def room_of(rule):
    """The room that a rule names: itself, or the folder of the unit that it names."""
    while rule not in ALLOWED:
        rule = rule.rsplit("/", 1)[0]
    return rule


def allowed_rooms():
    return {room: {room_of(rule) for rule in rules} - {room} for room, rules in ALLOWED.items()}


def reachable(allowed):
    """{room: everything that its arrows lead to}"""
    found = {}

    def walk(room):
        if room not in found:
            found[room] = allowed[room].union(*map(walk, allowed[room]))
        return found[room]
    return {room: walk(room) for room in allowed}


def arrows():
    """The allowed includes (room, included) that do not follow from others."""
    allowed = allowed_rooms()
    reach = reachable(allowed)
    return [(room, other) for room in allowed for other in sorted(allowed[room])
            if not any(other in reach[third] for third in allowed[room] - {other})]


def exceptions():
    """(room, what its arrows lead to and it may not include all the same) where there is any."""
    allowed = allowed_rooms()
    reach = reachable(allowed)
    return [(room, sorted(reach[room] - allowed[room])) for room in allowed if reach[room] - allowed[room]]


CAPTIONS = {
    "host/faces/cli": "palpate: commands", "host/faces/capi": "libpalpate.so, palpate.h",
    "host/faces/python": "import palpate", "host/faces/slicer": "3D Slicer module",
    "host/cohort": "plan, run, collect",
    "host/apps/phantom": "cases of known answer", "host/apps/export": "other solvers' files",
    "host/apps/simulate": "loads in, motion out", "host/apps/study": "many phantoms",
    "host/apps/recover/modelling": "settings, tissue, roles", "host/apps/recover/observations": "distances and their noise",
    "host/apps/recover/inverse": "search and intervals", "host/apps/recover/result": "what came out",
    "host/apps/recover/report": "HTML, JSON, text, VTK", "host/apps/recover/pipeline": "the row: recover.cpp",
    "host/estimate": "searches, posteriors", "host/page": "plots, tables, numbers",
    "host/geometry/fields": "labels, distances", "host/geometry/surfaces": "triangles, remeshing",
    "host/geometry/meshing": "surfaces to tetrahedra", "host/geometry/warping": "carry along a motion",
    "host/geometry/mesh_tool": "the program beside", "host/io": "volumes, settings",
    "host/system": "processes, signals, limits", "solver/base": "types, errors",
    "solver/mesh": "nodes, elements", "solver/elements": "shape functions", "solver/materials": "energy and stress",
    "solver/model": "what is asked", "solver/backend": "the interface", "solver/linear": "K x = b",
    "solver/equilibrium": "f(u) = 0", "solver/adjoint": "gradients", "solver/sensitivity": "forward columns",
    "solver/condense": "regions to surfaces",
    "solver/backends/reference": "plain host loops", "solver/backends/opencl": "runs kernels/*.cl",
    "solver/backends/kokkos": "OpenMP, CUDA, HIP", "solver/backends": "the list of them",
}
# Rooms that stand one above the other in their row.
STACKS = [["solver/materials", "solver/elements", "solver/mesh"]]
WIDTH, MARGIN, LABEL = 1280, 20, 150  # of the picture, its border and the column of names
BOX_HEIGHT, STACK_GAP, BOX_GAP, ROW_GAP = 46, 10, 26, 62
STYLE = """
  svg { color-scheme: light dark; font-family: system-ui, "Segoe UI", Helvetica, Arial, sans-serif; }
  .paper { fill: #ffffff; } .band { fill: #f4f6f8; } .room { fill: #ffffff; stroke: #57606a; }
  .faces { fill: #fde8d7; } .apps { fill: #e2ecfb; } .recover { fill: #cfe0fa; } .host { fill: #e3f3e1; }
  .solver { fill: #ece6f8; } .backends { fill: #f6e3ef; }
  text { fill: #1f2328; font-size: 13px; text-anchor: middle; } .name { font-weight: 600; }
  .caption { font-size: 10.5px; fill: #57606a; } .row { text-anchor: start; font-weight: 600; }
  .frame { fill: none; stroke: #8c959f; stroke-dasharray: 4 3; }
  .arrow { fill: none; stroke: #57606a; stroke-width: 1.3; } .head { fill: #57606a; }
  @media (prefers-color-scheme: dark) {
    .paper { fill: #0d1117; } .band { fill: #161b22; } .room { stroke: #8b949e; }
    .faces { fill: #4a2f1a; } .apps { fill: #1b2f4d; } .recover { fill: #234170; } .host { fill: #1d3b23; }
    .solver { fill: #35294f; } .backends { fill: #47243a; }
    text { fill: #e6edf3; } .caption { fill: #adb5bd; }
    .arrow { stroke: #9aa4af; } .head { fill: #9aa4af; }
  }
"""


def rows_of_columns():
    """[(name of the row, [column: [rooms from top to bottom]])], each room of the table once; rows without rooms go."""
    named = {pattern for _, patterns in ROWS for pattern in patterns}
    left = list(ALLOWED)
    rows = []
    for name, patterns in ROWS:
        row = []
        for pattern in patterns:
            if not pattern:
                row.append([])
            for room in [r for r in left if r == pattern
                         or (pattern.endswith("/") and r.startswith(pattern) and r not in named)]:
                left.remove(room)
                stack = next((s for s in STACKS if room in s), [room])
                if stack not in row:
                    row.append(stack)
        if any(row):
            rows.append((name, row))
    if left:
        raise SystemExit(f"scripts/draw_house.py: no row takes {', '.join(left)}; name it in ROWS")
    return rows


def places():
    """({room: (x, y, width)} of each box's upper left corner, [(name, y, height)] of the rows, height)"""
    boxes, bands, y = {}, [], MARGIN
    for name, columns in rows_of_columns():
        height = max(len(c) * (BOX_HEIGHT + STACK_GAP) - STACK_GAP for c in columns)
        step = (WIDTH - LABEL - 2 * MARGIN + BOX_GAP) / len(columns)
        for k, column in enumerate(columns):
            top = y + (height - len(column) * (BOX_HEIGHT + STACK_GAP) + STACK_GAP) / 2
            for n, room in enumerate(column):
                boxes[room] = (MARGIN + LABEL + k * step, top + n * (BOX_HEIGHT + STACK_GAP), step - BOX_GAP)
        bands.append((name, y - 10, height + 20))
        y += height + ROW_GAP
    return boxes, bands, y - ROW_GAP + MARGIN


def port(boxes, room, others, other, side):
    """Where the arrow between two rooms touches the first: spread along its side by where they lead."""
    x, y, width = boxes[room]
    order = sorted(others, key=lambda r: boxes[r][0])
    share = (order.index(other) + 1) / (len(order) + 1)
    return x + width * share, y + (BOX_HEIGHT if side == "bottom" else 0)


def row_numbers():
    return {room: k for k, (_, columns) in enumerate(rows_of_columns()) for c in columns for room in c}


def curve(start, bend_start, bend_end, end):
    return "M{:.0f},{:.0f} C{:.0f},{:.0f} {:.0f},{:.0f} {:.0f},{:.0f}".format(*start, *bend_start, *bend_end, *end)


def sideways(boxes, room, other):
    """To the left in a row: straight to a neighbour, else in a bow above what stands between."""
    (x0, y0, _), (x1, y1, width) = boxes[room], boxes[other]
    right, start, end = x1 + width, y0 + BOX_HEIGHT / 2, y1 + BOX_HEIGHT / 2
    if x0 - right < width / 2:
        middle = (x0 + right) / 2
        return curve((x0, start), (middle, start), (middle, end), (right + 7, end))
    return curve((x0 + 20, y0), (x0, y0 - 26), (right, y1 - 30), (right - 20, y1 - 7))


def lane(boxes, between, x0, x1):
    """An x from which a vertical line crosses all rooms `between` two rows without touching one."""
    edges = sorted((boxes[r][0], boxes[r][0] + boxes[r][2]) for r in between)
    free = [x for x in (x0, x1) if all(x < a - 8 or x > b + 8 for a, b in edges)]
    free += [x for a, b in edges for x in (a - 13, b + 13) if all(x < c - 8 or x > d + 8 for c, d in edges)]
    return min(free, key=lambda x: abs(x - x0) + abs(x - x1))


def path(boxes, all_arrows, room, other):
    rows = row_numbers()
    if rows[room] == rows[other]:
        return sideways(boxes, room, other)
    down = rows[other] > rows[room]
    out = [b for a, b in all_arrows if a == room and rows[b] != rows[a] and (rows[b] > rows[a]) == down]
    into = [a for a, b in all_arrows if b == other and rows[b] != rows[a] and (rows[b] > rows[a]) == down]
    sx, sy = port(boxes, room, out, other, "bottom" if down else "top")
    ex, ey = port(boxes, other, into, room, "top" if down else "bottom")
    ey += -7 if down else 7
    between = [r for r, k in rows.items() if rows[room] < k < rows[other]]
    if not between:
        middle = (sy + ey) / 2
        return curve((sx, sy), (sx, middle), (ex, middle), (ex, ey))
    x = lane(boxes, between, sx, ex)
    top = min(boxes[r][1] for r in between) - 12
    low = max(boxes[r][1] for r in between) + BOX_HEIGHT + 12
    first, last = (sy + top) / 2, (low + ey) / 2
    return (curve((sx, sy), (sx, first), (x, first), (x, top))
            + f" L{x:.0f},{low:.0f} C{x:.0f},{last:.0f} {ex:.0f},{last:.0f} {ex:.0f},{ey:.0f}")


def frame(boxes, folder):
    """A line round neighbours of one folder within a row, with its name."""
    inside = [place for room, place in boxes.items() if room.startswith(folder)]
    x, y = min(b[0] for b in inside) - 10, inside[0][1] - 17
    width = max(b[0] + b[2] for b in inside) + 10 - x
    return [f'<rect class="frame" x="{x:.0f}" y="{y:.0f}" width="{width:.0f}" height="{BOX_HEIGHT + 24}" rx="8"/>',
            f'<text class="caption" x="{x + 36:.0f}" y="{y + 12:.0f}">{folder.split("/", 1)[1]}</text>']


def picture():
    boxes, bands, height = places()
    all_arrows = arrows()
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:.0f}" role="img">',
             "<title>Rooms of palpate and what each may include</title>",
             f"<style>{STYLE}</style>",
             '<defs><marker id="head" viewBox="0 0 8 8" refX="1" refY="4" markerWidth="7" markerHeight="7" '
             'orient="auto"><path class="head" d="M0,0 L8,4 L0,8 z"/></marker></defs>',
             f'<rect class="paper" width="{WIDTH}" height="{height:.0f}"/>']
    for name, y, tall in bands:
        lines.append(f'<rect class="band" x="8" y="{y:.0f}" width="{WIDTH - 16}" height="{tall:.0f}" rx="8"/>')
        lines.append(f'<text class="row" x="{MARGIN}" y="{y + tall / 2 + 4:.0f}">{html.escape(name)}/</text>')
    lines += frame(boxes, "host/geometry/")
    for room, other in all_arrows:
        lines.append(f'<path class="arrow" marker-end="url(#head)" data-from="{room}" data-to="{other}" '
                     f'd="{path(boxes, all_arrows, room, other)}"/>')
    for room, (x, y, width) in boxes.items():
        row = next(name for name, columns in rows_of_columns() if any(room in c for c in columns))
        name = room.removeprefix(row + "/").removeprefix("geometry/") if room != row else "all.cpp"
        lines.append(f'<rect class="room {row.split("/")[-1]}" x="{x:.0f}" y="{y:.0f}" width="{width:.0f}" '
                     f'height="{BOX_HEIGHT}" rx="6"/>')
        middle = x + width / 2
        lines.append(f'<text class="name" x="{middle:.0f}" y="{y + 19:.0f}">{html.escape(name)}</text>')
        lines.append(f'<text class="caption" x="{middle:.0f}" y="{y + 35:.0f}">'
                     f'{html.escape(CAPTIONS.get(room, ""))}</text>')
    return "\n".join(lines + ["</svg>", ""])


def units_of(room):
    """{included room: names of its units} where a rule names units and not the whole room."""
    units = {}
    for rule in ALLOWED[room]:
        if room_of(rule) != rule:
            units.setdefault(room_of(rule), []).append(rule.rsplit("/", 1)[1])
    return units


def in_words(room, other):
    units = units_of(room).get(other)
    return f"`{other}`" + (f" (only {', '.join(units)})" if units else "")


def arrow_list():
    """The arrows in words, as they stand in the page."""
    lines = ["| room | may include, and what that may include | but not |", "| --- | --- | --- |"]
    all_arrows, but = arrows(), dict(exceptions())
    reach, allowed = reachable(allowed_rooms()), allowed_rooms()
    for room in ALLOWED:
        direct = [other for source, other in all_arrows if source == room]
        beyond = but.get(room, [])
        not_allowed = ", ".join(f"`{other}`" for other in beyond)
        if beyond and len(beyond) == len(reach[room]) - len(direct):
            not_allowed = "anything else"
        elif len(beyond) > 4:
            others = [f"`{other}`" for other in sorted(allowed[room] - set(direct))]
            not_allowed = f"anything else than {', '.join(others)}"
        included = ", ".join(in_words(room, other) for other in direct)
        lines.append(f"| `{room}` | {included or 'the standard library, Eigen, fmt'} | {not_allowed} |")
    return "\n".join(lines) + "\n"


def page_with_arrows(text):
    before, rest = text.split(BEGIN)
    return before + BEGIN + arrow_list() + END + rest.split(END)[1]


def main():
    wanted = {PICTURE: picture(), PAGE: page_with_arrows(PAGE.read_text())}
    if "--check" not in sys.argv:
        for path_, text in wanted.items():
            path_.write_text(text)
        return 0
    stale = [str(p.relative_to(ROOT)) for p, text in wanted.items() if not p.exists() or p.read_text() != text]
    print("house: " + (f"{' and '.join(stale)} differ from scripts/check_layers.py; run scripts/draw_house.py"
                       if stale else "ok"))
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main())
