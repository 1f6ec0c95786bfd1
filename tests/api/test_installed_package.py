# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Programs of others build against the installed package and run."""
import os
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "release"
CLIENT = ROOT / "tests" / "api" / "solver_client.c"


def run(*command, **options):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    folder = tmp_path_factory.mktemp("installed")
    run("cmake", "--install", BUILD, "--prefix", folder)
    return folder


def test_a_cmake_project_finds_the_package(prefix, tmp_path):
    output = run("cmake", "-S", ROOT / "tests" / "api" / "outside_project", "-B", tmp_path,
                 f"-DCMAKE_PREFIX_PATH={prefix}", f"-DSOLVER_CLIENT={CLIENT}")
    assert "back ends: reference" in output
    run("cmake", "--build", tmp_path)
    run(tmp_path / "outside")


def test_pkg_config_says_how_to_compile(prefix, tmp_path):
    (library,) = prefix.rglob("pkgconfig/palpate.pc")
    flags = run("pkg-config", "--cflags", "--libs", "palpate",
                env=os.environ | {"PKG_CONFIG_PATH": str(library.parent)}).split()
    run("cc", "-std=c99", CLIENT, "-o", tmp_path / "client", *flags, "-lm")
    run(tmp_path / "client",
        env=os.environ | {"LD_LIBRARY_PATH": str(library.parent.parent)})


def test_the_header_is_c99_and_cxx(prefix, tmp_path):
    source = tmp_path / "only_header.c"
    source.write_text('#include "palpate.h"\nint main(void) { return 0; }\n')
    for compiler, standard in (("cc", "-std=c99"), ("c++", "-std=c++11")):
        run(compiler, standard, "-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only",
            *(["-x", "c++"] if compiler == "c++" else []), f"-I{prefix / 'include'}", source)


def test_only_the_interface_is_visible(prefix):
    (library,) = [path for path in prefix.rglob("libpalpate.so")]
    symbols = [line.split()[-1].split("@")[0]
               for line in run("nm", "-D", "--defined-only", library).splitlines()]
    assert "palpate_recover" in symbols
    assert [name for name in symbols if not name.startswith(("palpate_", "PALPATE_"))] == []
