# SPDX-License-Identifier: GPL-2.0-or-later
"""examples/python/drain_and_plot.py, as a user runs it."""

import pathlib
import shutil
import subprocess
import sys

from PIL import Image

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"


def test_it_draws_a_picture(tmp_path):
    (tmp_path / "own-hopper").symlink_to(EXAMPLES / "own-hopper")
    shutil.copytree(EXAMPLES / "python", tmp_path / "python")
    picture = tmp_path / "python" / "drain_and_plot.png"
    picture.unlink(missing_ok=True)
    done = subprocess.run([sys.executable, "drain_and_plot.py"], cwd=tmp_path / "python", capture_output=True, text=True,
                          timeout=300)
    assert done.returncode == 0, done.stderr
    with Image.open(picture) as image:
        assert min(image.size) > 200
        assert len(image.convert("RGB").getcolors(1 << 20)) > 50  # something is on it


def test_it_has_ten_lines():
    lines = (EXAMPLES / "python" / "drain_and_plot.py").read_text().split('"""')[2].splitlines()
    statements = [line for line in lines if line and line[0] not in " #" and not line.startswith(("import", "from"))]
    assert len(statements) <= 10
