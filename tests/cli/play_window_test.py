# SPDX-License-Identifier: Apache-2.0
# Opens chandelier-play in a window on a display of its own.
import os
import select
import shutil
import signal
import subprocess
import time
import unittest

import numpy

from play_tool import PATIENCE_S, PLAY, PlayTest, SMALL, main


class OnADisplay(PlayTest):
    @classmethod
    def setUpClass(cls):
        if not shutil.which("Xvfb"):
            raise unittest.SkipTest("Xvfb is not installed")
        super().setUpClass()
        reading, writing = os.pipe()
        command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", "320x240x24", "-nolisten", "tcp", "-noreset"]
        cls.server = subprocess.Popen(command, pass_fds=[writing], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        cls.addClassCleanup(cls.stop_server)
        os.close(writing)
        assert select.select([reading], [], [], PATIENCE_S)[0], "Xvfb did not start"
        with os.fdopen(reading) as number:  # to the end of the line: a closed pipe would end the server
            cls.env = {**os.environ, "DISPLAY": ":" + number.readline().strip()}

    @classmethod
    def stop_server(cls):
        cls.server.terminate()
        cls.server.wait()

    def screen(self):
        raw = subprocess.run(["import", "-window", "root", "-depth", "8", "rgb:-"], env=self.env, check=True,
                             stdout=subprocess.PIPE).stdout
        return numpy.frombuffer(raw, numpy.uint8).reshape(240, 320, 3)

    def picture(self, pack, *options):
        """As chandelier-play draws it without a window."""
        self.play_well(pack, "--output", self.folder / "frame.png", *SMALL, *options)
        raw = subprocess.run(["convert", self.folder / "frame.png", "-depth", "8", "rgb:-"], check=True, stdout=subprocess.PIPE).stdout
        return numpy.frombuffer(raw, numpy.uint8).reshape(54, 96, 3)


class Window(OnADisplay):
    def test_closes_after_the_frames_asked_for(self):
        done = self.play(self.pack, "--frames", 3, "--validation", *SMALL, env=self.env)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("0 messages from the validation layer", done.stderr)

    @unittest.skipUnless(shutil.which("import") and shutil.which("convert"), "ImageMagick is not installed")
    def test_shows_the_picture_until_a_signal(self):
        wanted = self.picture(self.pack)
        window = subprocess.Popen([PLAY, self.pack, *SMALL], env=self.env, stderr=subprocess.PIPE, text=True)
        try:
            patience = time.monotonic() + PATIENCE_S
            while not numpy.array_equal(self.screen()[:54, :96], wanted) and time.monotonic() < patience:
                self.assertIsNone(window.poll(), "the window closed by itself")
                time.sleep(0.1)
            shown = self.screen()
            numpy.testing.assert_array_equal(shown[:54, :96], wanted)
            self.assertEqual(shown[54:].max(), 0)
        finally:
            window.send_signal(signal.SIGTERM)
            _, said = window.communicate(timeout=PATIENCE_S)
        self.assertEqual(window.returncode, 0, said)

    def test_without_a_display_there_is_a_hint(self):
        blind = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        self.assert_fails(1, "no display: use --output FILE.png", self.pack, env=blind)


if __name__ == "__main__":
    main()
