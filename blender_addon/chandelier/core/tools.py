# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds chandelier-bake and chandelier-play and runs them beside Blender."""

import contextlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass

# The passes that chandelier-bake --verbose names, in order, and how long each takes in a bake of some ten images (baker/README.md).
# Passes whose results are in the cache are left out.
PASSES = {
    "import": 6, "recentre": 1, "glass": 1, "materials": 1, "animation": 1, "find_geometry": 0, "normals": 1, "tangents": 2, "quantize": 5,
    "weld": 2, "clean": 3, "shells": 4, "batches": 12, "instances": 1, "batch_bvh": 1, "instance_bvh": 1, "triangle_bvh": 10, "voxels": 5,
    "keep_geometry": 1, "images": 20, "lights": 1, "light_bvh": 1, "light_audit": 2, "write": 13, "check": 4, "sync": 3}
PASS_LINE = re.compile(r"^chandelier-bake: +[\d.]+ s: +[\d.]+ s for (?:.+, )?(\w+)$")  # the last of passes that share a line
MESSAGE_LINE = re.compile(r"^chandelier-\w+: (error|warning): (.*)$")
PATIENCE_S = 3  # how long a program may take to end


class ToolError(Exception):
    """Its text is one line for the user."""


def program_name(tool):
    return tool + (".exe" if sys.platform == "win32" else "")


def make_executable(folder):
    """Makes the programs in `folder` executable, since Blender unpacks a zip without permissions. If that fails, the
    program is not found later."""
    for path in pathlib.Path(folder).glob("chandelier-*"):
        if path.is_file() and not os.access(path, os.X_OK):
            with contextlib.suppress(OSError):
                path.chmod(path.stat().st_mode | 0o111)


def find(tool, folders):
    """The path of a program in one of the folders, else in PATH."""
    name = program_name(tool)
    for folder in folders:
        path = pathlib.Path(folder) / name
        if path.is_file() and os.access(path, os.X_OK):
            return str(path)
    found = shutil.which(name)
    if found:
        return found
    looked = ", ".join(map(str, folders))
    raise ToolError(f"{tool}: is neither in PATH nor in {looked}: set its folder in the add-on's preferences")


def bake_command(program, scene, pack, cache=None):
    return [program, str(scene), "-o", str(pack), "--verbose", *(("--cache", str(cache)) if cache else ())]


@dataclass(frozen=True)
class Shown:
    """Options of chandelier-play; the fields have the options' names."""
    d_init: float = 0.5
    distance_scaling: str = "grow"
    z_far: float = 30
    dynamic_lights: str = "cluster"
    face_size: int = 512
    filter: str = "pcss"
    budget_maps: int = 0
    budget_mib: int = 0
    camera: str = ""


def play_command(program, pack, shown):
    command = [program, str(pack), "--preset", "lightcluster", "--filter", shown.filter, "--d-init", f"{shown.d_init:.9g}",
               "--distance-scaling", shown.distance_scaling, "--z-far", f"{shown.z_far:.9g}", "--dynamic-lights", shown.dynamic_lights,
               "--face-size", str(shown.face_size)]
    if shown.budget_maps:
        command += ["--max-shadow-maps", str(shown.budget_maps)]
    if shown.budget_mib:
        command += ["--max-shadow-bytes", str(shown.budget_mib)]
    return command + (["--camera", shown.camera] if shown.camera else [])


class Job:
    """A running program. Its output goes through a file, so it never waits for a reader."""

    def __init__(self, command):
        self.command, self.name = command, pathlib.Path(command[0]).stem
        self.partial = b""
        self.doing, self.warnings, self.last, self.error = "", [], "", ""
        self.passed = 0  # number of PASSES that are done or were left out
        self.cancelled = False
        writing, self.output_path = tempfile.mkstemp(prefix="chandelier-")
        self.output = open(self.output_path, "rb")
        try:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=writing)
        except OSError as error:
            self._forget_file()
            raise ToolError(f"{command[0]}: cannot be run ({error.strerror})") from None
        finally:
            os.close(writing)

    def _forget_file(self):
        self.output.close()
        os.unlink(self.output_path)

    def is_running(self):
        """Reads the new output. Returns False once the program has ended; `error` then says why it failed, if it did."""
        if self.output.closed:
            return False
        ended = self.process.poll() is not None
        self._read_lines(self.output.read())
        if ended:
            self._read_lines(b"\n")
            self._forget_file()
            self._set_error()
        return not ended

    def _read_lines(self, data):
        *lines, self.partial = (self.partial + data).split(b"\n")
        for line in lines:
            self._read_line(line.decode("utf-8", "replace").strip())

    def _read_line(self, line):
        done, message = PASS_LINE.match(line), MESSAGE_LINE.match(line)
        if done:
            order = list(PASSES)
            self.passed = max(self.passed, order.index(done[1]) + 1 if done[1] in PASSES else 0)
            self.doing = order[self.passed] if self.passed < len(order) else ""
        elif message and message[1] == "warning":
            self.warnings.append(message[2])
        elif message:
            self.error = message[2]
        if line:
            self.last = line

    def _set_error(self):
        code = self.process.returncode
        if self.cancelled:
            self.error = f"{self.name}: cancelled"
        elif code < 0:
            self.error = f"{self.name}: ended by signal {-code}"
        elif code > 0:
            self.error = f"{self.name}: {self.error or self.last or f'ended with status {code}'}"
        else:
            self.error = ""

    @property
    def progress(self):
        """0 to 1."""
        return sum(list(PASSES.values())[:self.passed]) / sum(PASSES.values())

    def cancel(self):
        """Ends the program, by force if it does not stop."""
        if not self.is_running():
            return
        self.cancelled = True
        self.process.terminate()
        try:
            self.process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.is_running()
