# SPDX-License-Identifier: GPL-2.0-or-later
"""lammps-package/ as a package of a LAMMPS source tree, of which there is a stand-in (source_tree/) and the installed headers and library."""

import os
import pathlib
import shutil
import subprocess

import pytest

from lammps_runs import LOAD_SPOT, ROOT, deck, drain, on_ranks, run_ok

PACKAGE = ROOT / "lammps-package"
BUILD = pathlib.Path(os.environ.get("SPOT_BUILD", str(ROOT / "build")))
LAMMPS_INCLUDES = "/usr/include/lammps"
LACKS_FMT = [] if os.path.exists(LAMMPS_INCLUDES + "/fmt") else ["-DSPOT_LAMMPS_LACKS_FMT"]
SOURCES = sorted(path.name for path in PACKAGE.iterdir() if path.suffix in (".cpp", ".h"))


def call(*command, cwd=None):
    done = subprocess.run([str(word) for word in command], cwd=cwd, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    """Where spot-core is installed."""
    folder = tmp_path_factory.mktemp("prefix")
    call("cmake", "--install", BUILD / "spot-core", "--prefix", folder)
    return folder


@pytest.fixture
def tree(tmp_path):
    """A source tree with the package in it, as lammps-package/README.md says."""
    shutil.copytree(pathlib.Path(__file__).parent / "source_tree", tmp_path / "lammps" / "cmake")
    (tmp_path / "lammps" / "src").mkdir()
    (tmp_path / "lammps" / "cmake" / "Modules" / "Packages").mkdir(parents=True)
    (tmp_path / "lammps" / "src" / "SPOT").symlink_to(PACKAGE)
    (tmp_path / "lammps" / "cmake" / "Modules" / "Packages" / "SPOT.cmake").symlink_to(PACKAGE / "cmake" / "SPOT.cmake")
    return tmp_path / "lammps"


def test_cmake(prefix, tree, tmp_path):
    """Built from the tree, the fix gives the same dump as in our lmp, and on two ranks."""
    build = tmp_path / "build"
    call("cmake", "-G", "Ninja", "-S", tree / "cmake", "-B", build, "-D", f"CMAKE_PREFIX_PATH={prefix}", "-D", "CMAKE_CXX_FLAGS=-Wall -Werror -O1")
    call("nice", "cmake", "--build", build)
    expected = drain(tmp_path / "ours")
    text = deck().replace(f"include {LOAD_SPOT}", "")
    for launcher in [()] + ([on_ranks(2)] if shutil.which("mpirun") else []):
        folder = tmp_path / f"theirs{len(launcher)}"
        folder.mkdir()
        run_ok(text, folder, program=str(build / "lammps"), launcher=launcher)
        assert (folder / "grains.dump").read_bytes() == expected


MAKEFILE_PACKAGE = "PKG_INC =   \nPKG_PATH =  \nPKG_LIB =   \n\nPKG_SYSINC =  \nPKG_SYSLIB =  \nPKG_SYSPATH = \n"
# What LAMMPS' src/Install.sh does for packages.
COPY = 'for file in *.cpp *.h; do if [ $1 = 0 ]; then rm -f ../$file; else cp $file ..; fi; done\n'


def test_make(prefix, tree):
    """In and out again; the fix can be compiled with the settings that were made."""
    source = tree / "src"
    (source / "SPOT").unlink()
    shutil.copytree(PACKAGE, source / "SPOT")
    settings = source / "Makefile.package"
    settings.write_text(MAKEFILE_PACKAGE)
    (source / "Install.sh").write_text(COPY)
    for _ in range(2):  # the second time changes nothing
        call("sh", "Install.sh", 1, cwd=source / "SPOT")
        assert sorted(path.name for path in source.iterdir() if path.suffix in (".cpp", ".h")) == SOURCES
    assert settings.read_text().count("-lspot-core -lpthread ") == 1
    (tree / "flags.mk").write_text(f"include {settings}\nflags:\n\t@echo $(PKG_SYSINC)\n")
    flags = call("make", "-s", "-f", tree / "flags.mk", "flags").split()
    # This one includes all headers.
    call("mpicxx", "-std=c++11", *flags, "-fsyntax-only", *LACKS_FMT, "-DOMPI_SKIP_MPICXX", f"-I{prefix}/include", "-I.",
         "-isystem", LAMMPS_INCLUDES, "fix_spot.cpp", cwd=source)
    call("sh", "Install.sh", 0, cwd=source / "SPOT")
    assert settings.read_text() == MAKEFILE_PACKAGE
    assert sorted(path.name for path in source.iterdir()) == ["Install.sh", "Makefile.package", "SPOT"]


def test_nothing_but_the_package_would_be_compiled():
    """LAMMPS takes every source in the folder."""
    assert not {"lmp.cpp", "plugin_load.cpp", "register_spot.cpp", "main.cpp"} & set(SOURCES)
    for name in SOURCES:
        assert (PACKAGE / name).read_text().startswith("// SPDX-License-Identifier: GPL-2.0-only\n"), name
