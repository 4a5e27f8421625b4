# SPDX-License-Identifier: Apache-2.0
# What tests of chandelier-play share: the Cornell box baked, the program run in a folder of its own, what it wrote looked at.
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

import jsonschema

SOURCE = pathlib.Path(os.environ["CHANDELIER_SOURCE"])
PLAY = os.environ["CHANDELIER_PLAY"]
BAKE = os.environ["CHANDELIER_BAKE"]
SKIPPED = 77  # exit status that ctest shows as "Skipped"
LIGHTS = 32  # in examples/cornell.py
SMALL = ["--size", "96x54", "--face-size", "64"]
PATIENCE_S = 120  # before a hang is called one; no test asserts a time


def bake(scene, pack):
    subprocess.run([BAKE, scene, "-o", pack], check=True, stdout=subprocess.DEVNULL)


def schema_validator(name):
    schemas = {page.name: json.loads(page.read_text()) for page in (SOURCE / "schemas").glob("*.schema.json")}
    jsonschema.Draft202012Validator.check_schema(schemas[name])
    resolver = jsonschema.RefResolver(name, schemas[name], store=schemas)
    return jsonschema.Draft202012Validator(schemas[name], resolver=resolver)


def png_size(path):
    head = pathlib.Path(path).read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", head[16:24])


class PlayTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.TemporaryDirectory()
        cls.pack = pathlib.Path(cls.made.name) / "cornell.chandelier"
        scene = cls.pack.with_suffix(".glb")
        subprocess.run([sys.executable, SOURCE / "examples/cornell.py", "-o", scene], check=True, stdout=subprocess.DEVNULL)
        bake(scene, cls.pack)

    @classmethod
    def tearDownClass(cls):
        cls.made.cleanup()

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def play(self, *arguments, env=None):
        return subprocess.run([PLAY, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder, env=env,
                              timeout=PATIENCE_S)

    def play_well(self, *arguments):
        done = self.play(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def assert_fails(self, code, because, *arguments, env=None):
        before = sorted(self.folder.rglob("*"))
        done = self.play(*arguments, env=env)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertRegex(done.stderr, r"\Achandelier-play: error: [^\n]+\n\Z")
        self.assertRegex(done.stderr, because)
        self.assertEqual(sorted(self.folder.rglob("*")), before, "something was left behind")

    def stats(self, *arguments):
        self.play_well(self.pack, "--output", "s.png", "--stats", "s.json", *SMALL, *arguments)
        stats = json.loads((self.folder / "s.json").read_text())
        schema_validator("stats.schema.json").validate(stats)
        return stats


def main():
    result = unittest.main(exit=False, verbosity=2).result
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(SKIPPED if len(result.skipped) > 0 and result.testsRun <= len(result.skipped) else 0)
