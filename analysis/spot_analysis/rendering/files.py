# SPDX-License-Identifier: GPL-2.0-or-later
"""Images to PNG, animated GIF or WebP, and MP4."""

import os
import shutil
import subprocess

from ..base.errors import AnalysisError

ANIMATIONS = (".gif", ".webp", ".mp4")


def check_output(path):
    """Raise AnalysisError, before any work, where ``path`` can't be written."""
    ending = os.path.splitext(path)[1].lower()
    if ending and ending not in (".png", ".vtk", *ANIMATIONS):
        raise AnalysisError(f"{path}: unknown kind of picture '{ending}'; known are .png, {', '.join(ANIMATIONS)}, .vtk, and a folder of "
                            "PNG frames, which has no ending")
    folder = os.path.dirname(path) or "."
    if not os.path.isdir(folder):
        raise AnalysisError(f"{path}: no folder {folder}")
    if ending == ".mp4" and not shutil.which("ffmpeg"):
        raise AnalysisError(f"{path}: MP4 needs the program ffmpeg, which is not here (Debian: ffmpeg); .webp and .gif do without")


def write_frames(folder, images):
    """frame.0000.png, ..."""
    os.makedirs(folder, exist_ok=True)
    for number, image in enumerate(images):
        image.save(os.path.join(folder, f"frame.{number:04}.png"))


def write_animation(path, images, fps, quality):
    """images : all of one size; quality : 0-100, of WebP"""
    ending = os.path.splitext(path)[1].lower()
    if ending == ".mp4":
        _write_mp4(path, images, fps)
        return
    if ending == ".gif":
        # one palette for all frames, without dithering: colours stay put and the file small
        palette = images[len(images) // 2].quantize(128)
        images = [image.quantize(palette=palette, dither=0) for image in images]
    options = {"quality": quality, "method": 4} if ending == ".webp" else {"optimize": False}
    images[0].save(path, save_all=True, append_images=images[1:], duration=round(1000 / fps), loop=0, **options)


def _write_mp4(path, images, fps):
    width, height = images[0].size
    command = ["ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", f"{fps:g}",
               "-i", "-", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", path]
    done = subprocess.run(command, input=b"".join(image.tobytes() for image in images), capture_output=True)
    if done.returncode:
        raise AnalysisError(f"{path}: ffmpeg failed: {done.stderr.decode(errors='replace').strip().splitlines()[-1:]}")
