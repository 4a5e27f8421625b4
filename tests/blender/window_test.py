# SPDX-License-Identifier: Apache-2.0
"""The add-on in a real window under Xvfb: panels draw without complaint, a bake runs beside Blender, the player shows it."""

import os
import pathlib
import select
import shutil
import stat
import subprocess
import sys
import tempfile
import unittest

import numpy as np

from run_in_blender import HERE, SKIPPED, SOURCE, blender, environment

BIN = pathlib.Path(os.environ.get("CHANDELIER_BIN", SOURCE / "build" / "bin"))
SIZE = (1280, 900)
PATIENCE_S = 600
SLOW_BAKE = "#!/bin/sh\necho 'chandelier-bake:    0.10 s:   0.10 s for import' >&2\nexec sleep 60\n"


class Window(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if not blender():
            raise unittest.SkipTest("no blender")
        for program in ("Xvfb", "import", "convert", "xwininfo"):
            if not shutil.which(program):
                raise unittest.SkipTest(f"no {program}")
        if not (BIN / "chandelier-play").exists():
            raise unittest.SkipTest(f"no chandelier-play in {BIN}")
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        cls.said = cls.run_blender(cls.start_display())

    @classmethod
    def start_display(cls):
        reading, writing = os.pipe()
        command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", f"{SIZE[0]}x{SIZE[1]}x24", "-nolisten", "tcp", "-noreset"]
        server = subprocess.Popen(command, pass_fds=[writing], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        cls.addClassCleanup(server.wait)
        cls.addClassCleanup(server.terminate)
        os.close(writing)
        assert select.select([reading], [], [], 60)[0], "Xvfb did not start"
        with os.fdopen(reading) as number:
            return ":" + number.readline().strip()

    @classmethod
    def run_blender(cls, display):
        slow = cls.folder / "slow" / "chandelier-bake"
        slow.parent.mkdir()
        slow.write_text(SLOW_BAKE)
        slow.chmod(slow.stat().st_mode | stat.S_IXUSR)
        command = [blender(), "--factory-startup", "--enable-event-simulate", "--window-geometry", "0", "0", *map(str, SIZE),
                   "--python-exit-code", "3", "--python", HERE / "in_blender" / "window_steps.py", "--", cls.folder, BIN]
        done = subprocess.run(command, env={**environment(cls.folder / "user"), "DISPLAY": display}, timeout=PATIENCE_S,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        keep = os.environ.get("CHANDELIER_SCREENSHOTS")  # a folder, for whoever wants to look
        if keep:
            for path in cls.folder.glob("*.png"):
                shutil.copy(path, keep)
        return done.stdout

    def picture(self, name):
        raw = subprocess.run(["convert", self.folder / f"{name}.png", "-depth", "8", "rgb:-"], check=True,
                             stdout=subprocess.PIPE).stdout
        return np.frombuffer(raw, np.uint8).reshape(SIZE[1], SIZE[0], 3).astype(int)

    def test_all_steps_were_seen(self):
        seen = [line[6:] for line in self.said.splitlines() if line.startswith("seen: ")]
        self.assertEqual(seen, ["the tab", "baking True", "baked", "player", "its lights", "a light less after saving",
                                "the same player", "player closed", "error", "progress",
                                "cancelled", "the end"], self.said)

    def test_nothing_was_complained_of(self):
        for word in ("Traceback", "rna_uiItem", "unknown operator", "not found", "EXCEPTION"):
            self.assertNotIn(word, self.said)

    def test_the_error_is_red_and_the_progress_is_in_the_status_bar(self):
        panel, error, progress = (self.picture(name) for name in ("panel", "error", "progress"))

        def red(picture):
            return int(((picture[..., 0] > 180) & (picture[..., 1:].max(axis=2) < 150) & (picture[..., 2] > 90)).sum())

        self.assertGreater(red(error), red(panel) + 200)
        bar = (slice(SIZE[1] - 22, None), slice(0, 500))
        self.assertGreater(int((abs(progress[bar] - error[bar]).max(axis=2) > 40).sum()), 100)


if __name__ == "__main__":
    program = unittest.main(exit=False)
    skipped = program.result.skipped and not program.result.testsRun
    sys.exit(SKIPPED if skipped else not program.result.wasSuccessful())
