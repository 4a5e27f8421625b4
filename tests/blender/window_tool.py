# SPDX-License-Identifier: Apache-2.0
"""Runs a script in a Blender that has a window, on a display of its own."""

import os
import pathlib
import shutil
import subprocess
import tempfile

import run_in_blender

HERE = pathlib.Path(__file__).resolve().parent
SIZE = (1280, 800)


def missing():
    """The first program that is not here, or nothing."""
    if not run_in_blender.blender():
        return "blender"
    return next((program for program in ("Xvfb", "import") if not shutil.which(program)), "")


def run(script, shots, screen=SIZE, timeout=600):
    """Blender's output; its pictures are in `shots`."""
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", f"{screen[0]}x{screen[1]}x24", "-nolisten", "tcp"],
                              pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        with tempfile.TemporaryDirectory() as folder, os.fdopen(read) as number:
            variables = run_in_blender.environment(pathlib.Path(folder))
            variables.update(DISPLAY=f":{number.readline().strip()}", CHANDELIER_SHOTS=str(shots), LIBGL_ALWAYS_SOFTWARE="1")
            command = [run_in_blender.blender(), "--factory-startup", "--enable-event-simulate", "--python-exit-code", "3",
                       "--no-window-focus", "--window-geometry", "0", "0", *map(str, screen), "--python", HERE / "in_window" / script]
            return subprocess.run(command, env=variables, capture_output=True, text=True, timeout=timeout)
    finally:
        server.terminate()
        server.wait()
