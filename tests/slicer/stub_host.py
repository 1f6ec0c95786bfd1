# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""What 3D Slicer does with a command line module: asks for its description, builds a command line from
it, follows the tags on its output and loads outputs only after success."""
import os
import re
import subprocess
import time
import xml.etree.ElementTree

DISCOVERY_LIMIT_S = 5.0
TAG = re.compile(r"<(filter-start|filter-end|filter-progress|filter-stage-progress|filter-name|"
                 r"filter-comment|filter-time)>(.*?)</\1>", re.S)
GROUP_TEXTS = ("label", "description")


def discover(program):
    """(description as XML root, standard error, seconds) as the host asks for it."""
    begin = time.monotonic()
    finished = subprocess.run([str(program), "--xml"], capture_output=True, text=True,
                              timeout=DISCOVERY_LIMIT_S,
                              env={**os.environ, "ITK_AUTOLOAD_PATH": ""})
    assert finished.returncode == 0, finished.stderr
    assert finished.stdout.startswith("<?xml")
    root = xml.etree.ElementTree.fromstring(finished.stdout.encode())
    return root, finished.stderr, time.monotonic() - begin


def parameters(root):
    """[(type, element)] in the order of the description."""
    return [(element.tag, element) for group in root.findall("parameters") for element in group
            if element.tag not in GROUP_TEXTS]


def command_line(program, root, values, return_file):
    """Flags first, indexed arguments last, booleans bare, as the host builds it."""
    command, indexed = [str(program), "--returnparameterfile", str(return_file)], {}
    for kind, element in parameters(root):
        name, flag, index = (element.findtext(tag) for tag in ("name", "longflag", "index"))
        value = values.get(name, element.findtext("default"))
        if index is not None:
            indexed[int(index)] = str(value)
        elif flag and kind == "boolean":
            command += [f"--{flag}"] if value in (True, "true") else []
        elif flag and value is not None:
            command += [f"--{flag}", str(value)]
    return command + [indexed[k] for k in sorted(indexed)]


class Run:
    """A finished module: exit code, what is on stderr, progress, log without tags, return values."""

    def __init__(self, finished, return_file):
        self.exit_code, self.error, self.output = (finished.returncode, finished.stderr,
                                                   finished.stdout)
        tags = TAG.findall(finished.stdout)
        self.tags = [name for name, _ in tags]
        self.progress = [float(text) for name, text in tags if name == "filter-progress"]
        self.log = TAG.sub("", finished.stdout)
        self.returned = {}
        if return_file.exists():
            for line in return_file.read_text().splitlines():
                name, _, value = line.partition(" = ")
                self.returned[name] = value


def run(program, root, values, folder, **options):
    return_file = folder / "return.txt"
    command = command_line(program, root, values, return_file)
    return Run(subprocess.run(command, capture_output=True, text=True, timeout=300, **options),
               return_file)
