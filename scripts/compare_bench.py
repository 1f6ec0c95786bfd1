#!/usr/bin/env python3
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Prints how many times faster one set of benchmark rows is than another.

  compare_bench.py OLD.json NEW.json [--filter REGEX]
      the rows of the same name in two files of --benchmark_out: ratio = old time / new time
  compare_bench.py --within FILE.json --reference REGEX [--filter REGEX]
      rows of one file whose names differ in one part between slashes, which in the reference is
      matched by REGEX as a whole: ratio = reference time / row time

A ratio above 1 means that the new file, or the row beside the reference, is faster. Where a row was
repeated its median counts. Exit code 0, or 2 with one sentence if nothing can be compared.
"""
import argparse
import json
import re
import statistics
import sys

NANOSECONDS = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}
# What Google Benchmark appends to say how it measured, not what.
HOW = re.compile(r"/(iterations:\d+|repeats:\d+|min_time:[\d.]+|manual_time|real_time|process_time)"
                 r"(?=/|$)")


class CannotCompare(Exception):
    """One sentence for the user."""


def read_rows(path):
    """Time in ns by row name, in the order of the file; rows with an error are left out."""
    try:
        with open(path, encoding="utf-8") as file:
            entries = json.load(file)["benchmarks"]
        return medians(entries)
    except OSError as error:
        raise CannotCompare(f"{path} cannot be read: {error.strerror}.") from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise CannotCompare(f"{path} is not a JSON file of Google Benchmark "
                            "(--benchmark_out=FILE --benchmark_out_format=json).") from error


def medians(entries):
    single, median = {}, {}
    for entry in entries:
        if entry.get("error_occurred"):
            continue
        name = HOW.sub("", entry.get("run_name", entry["name"]))
        if entry.get("run_type") == "aggregate":
            if entry["aggregate_name"] == "median":
                median[name] = time_of(entry)
        else:
            single.setdefault(name, []).append(time_of(entry))
    rows = {name: statistics.median(times) for name, times in single.items()}
    return {**rows, **median}


def time_of(entry):
    return float(entry["real_time"]) * NANOSECONDS[entry["time_unit"]]


def pairs_of_files(old, new):
    """(name, old time, new time) of every row in both."""
    return [(name, time, new[name]) for name, time in old.items() if name in new]


def pairs_within(rows, reference):
    """(name, time of its reference, its time) of every row that has a reference."""
    references = {}
    for name, time in rows.items():
        for family, part in families(name):
            if reference.fullmatch(part):
                if family in references:
                    raise CannotCompare(f"Two rows, {name} among them, are references of "
                                        f"{'/'.join(family)}; give a narrower --reference.")
                references[family] = time
    pairs = []
    for name, time in rows.items():
        for family, part in families(name):
            if family in references and not reference.fullmatch(part):
                pairs.append((name, references[family], time))
    return pairs


def families(name):
    """Each part of a name with the name that is left when a star stands for it."""
    parts = name.split("/")
    for position, part in enumerate(parts):
        yield (*parts[:position], "*", *parts[position + 1:]), part


def readable(time_ns):
    for unit in ("s", "ms", "us"):
        if time_ns >= NANOSECONDS[unit]:
            return f"{time_ns / NANOSECONDS[unit]:.3g} {unit}"
    return f"{time_ns:.3g} ns"


def table(pairs, before, after):
    rows = [("row", before, after, "ratio")]
    for name, old, new in pairs:
        rows.append((name, readable(old), readable(new), f"{old / new:.2f}" if new > 0 else "-"))
    widths = [max(len(row[column]) for row in rows) for column in range(4)]
    return "\n".join("  ".join([row[0].ljust(widths[0]),
                                *(cell.rjust(w) for cell, w in zip(row[1:], widths[1:]))])
                     for row in rows)


def regular_expression(text):
    try:
        return re.compile(text)
    except re.error as error:
        raise CannotCompare(f"'{text}' is not a regular expression: {error}.") from error


def compare(arguments):
    if arguments.within:
        if arguments.files or arguments.reference is None:
            raise CannotCompare("--within takes one file, --reference and no other files.")
        pairs = pairs_within(read_rows(arguments.within), regular_expression(arguments.reference))
        titles = ("reference", "row")
    else:
        if len(arguments.files) != 2 or arguments.reference is not None:
            raise CannotCompare("Give two JSON files, or --within FILE --reference REGEX.")
        pairs = pairs_of_files(*map(read_rows, arguments.files))
        titles = ("old", "new")
    wanted = regular_expression(arguments.filter)
    pairs = [pair for pair in pairs if wanted.search(pair[0])]
    if not pairs:
        raise CannotCompare("No two rows can be compared; names must agree, and rows that ended in "
                            "an error do not count.")
    return table(pairs, *titles)


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", metavar="FILE.json")
    parser.add_argument("--within", metavar="FILE.json")
    parser.add_argument("--reference", metavar="REGEX")
    parser.add_argument("--filter", metavar="REGEX", default="", help="only rows whose name holds it")
    try:
        print(compare(parser.parse_args(argv)))
    except CannotCompare as error:
        print(f"compare_bench.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
