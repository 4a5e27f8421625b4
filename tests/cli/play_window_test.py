# SPDX-License-Identifier: Apache-2.0
# Opens chandelier-play in a window on a display of its own, and replaces the pack that it shows.
import json
import os
import re
import select
import shutil
import signal
import struct
import subprocess
import time
import unittest

import numpy

from play_tool import LIGHTS, PATIENCE_S, PLAY, PlayTest, SMALL, bake, main
from x11_tool import ICONIC, NORMAL, XWindow


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

    def picture(self, pack, *options, size=(96, 54)):
        """As chandelier-play draws it without a window."""
        small = ["--size", f"{size[0]}x{size[1]}", *SMALL[2:]]
        self.play_well(pack, "--output", self.folder / "frame.png", *small, *options)
        raw = subprocess.run(["convert", self.folder / "frame.png", "-depth", "8", "rgb:-"], check=True, stdout=subprocess.PIPE).stdout
        return numpy.frombuffer(raw, numpy.uint8).reshape(size[1], size[0], 3)


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


def edited(scene, path, edit):
    """A GLB with another JSON."""
    data = scene.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20:20 + size])
    edit(document)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + size:]
    path.write_bytes(struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest)


class ShownFile(OnADisplay):
    """A window that shows a file, and another pack to put in its place."""
    FEWER = 12  # lights of the other pack

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.other = cls.pack.with_name("other.chandelier")

        def put_lights_out(document):
            nodes = [node for node in document["nodes"] if "KHR_lights_punctual" in node.get("extensions", {})]
            for node in nodes[cls.FEWER:]:
                del node["extensions"]["KHR_lights_punctual"]

        edited(cls.pack.with_suffix(".glb"), cls.other.with_suffix(".glb"), put_lights_out)
        bake(cls.other.with_suffix(".glb"), cls.other)

    def setUp(self):
        super().setUp()
        self.shown = self.folder / "shown.chandelier"
        self.pictures = {pack: self.picture(pack) for pack in (self.pack, self.other)}
        self.assertGreater(int((self.pictures[self.pack] != self.pictures[self.other]).sum()), 1000)

    def put(self, content):
        """As the baker does: beside it, then renamed."""
        beside = self.folder / "beside"
        beside.write_bytes(content)
        beside.replace(self.shown)

    def open(self, *options):
        self.put(self.pack.read_bytes())
        with open(self.folder / "said", "w") as said:
            self.window = subprocess.Popen([PLAY, self.shown, *SMALL, *options], env=self.env, stderr=said)
        self.addCleanup(self.window.wait)
        self.addCleanup(self.window.kill)
        self.wait_for_picture(self.pack)

    def said(self):
        return (self.folder / "said").read_text().splitlines()

    def title(self):
        windows = subprocess.run(["xwininfo", "-root", "-tree"], env=self.env, check=True, capture_output=True, text=True).stdout
        return re.search(r'"(shown\.chandelier.*?)": \(', windows)[1]

    def wait(self, is_so, what):
        patience = time.monotonic() + PATIENCE_S
        while not is_so():
            self.assertIsNone(self.window.poll(), f"the window closed by itself: {self.said()}")
            self.assertLess(time.monotonic(), patience, f"waited for {what}: {self.said()}")
            time.sleep(0.1)

    def wait_for_picture(self, pack):
        self.wait(lambda: numpy.array_equal(self.screen()[:54, :96], self.pictures[pack]), f"the picture of {pack.name}")

    def wait_for_warning(self, says):
        """A new last line, which is said once."""
        before = len(self.said())
        self.wait(lambda: len(self.said()) > before, says)
        time.sleep(1.5)  # three more looks
        self.assertEqual(len(self.said()), before + 1, self.said())
        self.assertRegex(self.said()[-1], rf"\Achandelier-play: warning: {re.escape(str(self.shown))}: {says}.*; the older one stays\Z")
        self.wait(lambda: "an older one" in self.title(), "the title")

    def close(self):
        self.window.send_signal(signal.SIGTERM)
        self.assertEqual(self.window.wait(PATIENCE_S), 0, self.said())


NEEDED = ("import", "convert", "xwininfo")


@unittest.skipUnless(all(map(shutil.which, NEEDED)), "ImageMagick or xwininfo is not installed")
class Reload(ShownFile):
    def test_a_pack_that_is_replaced_is_shown(self):
        self.open("--validation")
        self.assertRegex(self.title(), rf"\Ashown.chandelier: reference, .* {LIGHTS} lights, {LIGHTS} shadow maps\Z")
        self.put(self.other.read_bytes())
        self.wait_for_picture(self.other)
        self.wait(lambda: f" {self.FEWER} lights" in self.title(), "the title")
        self.put(self.pack.read_bytes()[:-1000])
        self.wait_for_warning("header.file_bytes: [0-9]+ where the file has [0-9]+")
        self.wait_for_picture(self.other)
        self.put(self.pack.read_bytes())
        self.wait_for_picture(self.pack)
        self.assertRegex(self.title(), rf"\Ashown.chandelier: reference, .* {LIGHTS} lights")
        self.close()
        self.assertRegex(self.said()[1], rf"\A{re.escape(str(self.shown))}: \d+ frames drawn, the last 96x54, reference, {LIGHTS} lights")
        self.assertEqual(self.said()[2:], ["chandelier-play: 0 messages from the validation layer"])

    def test_what_cannot_be_shown_is_told_once_and_the_older_one_stays(self):
        whole = self.other.read_bytes()
        damaged = whole[:-5000] + bytes([whole[-5000] ^ 0x55]) + whole[-4999:]
        self.open()
        for content, says in ((b"", "too short for a pack"), (b"no pack at all\n" * 99, "not a Chandelier pack"),
                              (damaged, ""), (whole[:8] + b"\1\0\0\0" + whole[12:], "a pack of an older chandelier-bake: bake it again")):
            with self.subTest(says=says):
                self.put(content)
                self.wait_for_warning(says)
        away = self.folder / "away"
        self.shown.rename(away)
        self.wait_for_warning("cannot open \\(No such file or directory\\)")
        self.shown.mkdir()
        self.wait_for_warning("not a file \\(a folder\\)")
        self.shown.rmdir()
        self.wait_for_warning("cannot open")
        self.wait_for_picture(self.pack)
        self.put(whole)
        self.wait_for_picture(self.other)
        self.wait(lambda: "older" not in self.title(), "the title")
        self.shown.rename(away)
        self.wait_for_warning("cannot open")
        away.rename(self.shown)  # the same file again
        self.wait(lambda: "older" not in self.title(), "the title")
        self.close()

    def test_a_file_that_is_written_in_place(self):
        budget = ["--preset", "chandelier", "--max-shadow-maps", "9"]
        self.pictures = {pack: self.picture(pack, *budget) for pack in self.pictures}
        self.open(*budget)
        whole = self.other.read_bytes()
        with open(self.shown, "wb") as file:
            self.wait_for_warning("too short for a pack")
            file.write(whole[:len(whole) // 2])
            file.flush()
            self.wait_for_warning("header.file_bytes")
            self.wait_for_picture(self.pack)
            file.write(whole[len(whole) // 2:])
        self.wait_for_picture(self.other)
        self.close()
        lights = [re.search(r"a shadow map for each of (\d+) lights: selection by error makes 9", line) for line in self.said()]
        self.assertEqual([int(found[1]) for found in lights if found], [LIGHTS, self.FEWER])  # kept anew


@unittest.skipUnless(all(map(shutil.which, NEEDED)), "ImageMagick or xwininfo is not installed")
class Idle(ShownFile):
    """Frames are counted, not seconds: a window that draws without a reason draws many in each of these."""
    REST_S = 2

    def open(self, *options):
        super().open(*options)
        self.x = XWindow(self.env["DISPLAY"], self.shown.name)
        self.addCleanup(self.x.close)

    def frames(self):
        """Closes the window: how many it has drawn."""
        self.close()
        return int(re.search(r": (\d+) frames drawn", "\n".join(self.said()))[1])

    def test_a_window_that_nobody_touches_draws_once(self):
        self.open()
        time.sleep(self.REST_S)
        self.assertEqual(self.frames(), 1)

    def test_what_lay_under_another_window_is_shown_again_without_drawing(self):
        self.open()
        for _ in range(3):
            self.x.cover_and_uncover()
            self.wait_for_picture(self.pack)
            time.sleep(0.3)
        self.assertEqual(self.frames(), 1)

    def test_a_key_draws_and_a_rest_follows(self):
        self.open()
        pictures = {"off": self.pictures[self.pack], "on": self.picture(self.pack, "--headlight", "on")}
        self.assertGreater(int((pictures["on"] != pictures["off"]).sum()), 1000)
        for light in ("on", "off", "on"):
            self.x.key("h")
            self.wait(lambda: numpy.array_equal(self.screen()[:54, :96], pictures[light]), f"the headlight {light}")
        time.sleep(self.REST_S)
        self.assertEqual(self.frames(), 4)

    def test_flying_draws(self):
        self.open()
        self.x.key("w")
        self.wait(lambda: not numpy.array_equal(self.screen()[:54, :96], self.pictures[self.pack]), "another picture")
        self.assertGreater(self.frames(), 1)

    def test_another_size_draws(self):
        self.open()
        self.x.resize(128, 72)
        larger = self.picture(self.pack, size=(128, 72))
        self.wait(lambda: numpy.array_equal(self.screen()[:72, :128], larger), "the larger picture")
        time.sleep(self.REST_S)
        self.assertLessEqual(self.frames(), 3)  # the size may be told before the window has it

    def test_a_new_pack_is_shown_by_an_idle_window_but_not_by_a_minimised_one(self):
        self.open()
        time.sleep(self.REST_S)
        self.put(self.other.read_bytes())
        self.wait_for_picture(self.other)
        self.x.set_state(ICONIC)
        time.sleep(0.5)
        self.put(self.pack.read_bytes())
        time.sleep(self.REST_S)
        numpy.testing.assert_array_equal(self.screen()[:54, :96], self.pictures[self.other])
        self.x.set_state(NORMAL)
        self.wait_for_picture(self.pack)
        self.assertEqual(self.frames(), 3)


if __name__ == "__main__":
    main()
