#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The add-on as an extension, by Blender's own commands: what they say of folder and zip, and the zip as a user installs it, with
a library aboard. Skipped before Blender 4.2, which knows no extensions."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from run_in_blender import HERE, SKIPPED, SOURCE, blender, environment

ADDON = SOURCE / "blender_addon"
BUILD = pathlib.Path(os.environ.get("CHANDELIER_BUILD", SOURCE / "build"))
LIBRARY = BUILD / "lib" / "libchandelier_preview.so"
MODULE = "bl_ext.user_default.chandelier"
IS_INSTALLED = f"""
import bpy, importlib
assert {MODULE!r} in bpy.context.preferences.addons
assert bpy.context.scene.chandelier.d_init == 0.5
print("library:", importlib.import_module({MODULE + ".core.clusters"!r}).find().path)
"""


def version():
    """(4, 3) of "Blender 4.3.2"; (0, 0) without one."""
    said = subprocess.run([blender(), "--version"], capture_output=True, text=True).stdout if blender() else ""
    found = re.match(r"Blender (\d+)\.(\d+)", said)
    return (int(found[1]), int(found[2])) if found else (0, 0)


class Extension(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if version() < (4, 2):
            raise unittest.SkipTest("no Blender with extensions")
        if not LIBRARY.exists():
            raise unittest.SkipTest(f"no {LIBRARY}")
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        cls.variables = environment(cls.folder)
        (cls.folder / "extensions" / "user_default" / "chandelier").unlink(missing_ok=True)  # the zip is what is installed
        cls.variables["CHANDELIER_ADDON"] = MODULE
        cls.zip = cls.folder / "chandelier.zip"
        subprocess.run([sys.executable, ADDON / "make_zip.py", "-o", cls.zip, LIBRARY], check=True, stdout=subprocess.DEVNULL)

    def run_blender(self, *arguments):
        done = subprocess.run([blender(), *arguments], env=self.variables, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout

    def assert_valid(self, path):
        said = self.run_blender("--command", "extension", "validate", path)
        self.assertIn("Success", said)
        self.assertNotRegex(said, "(?i)error|warning")

    def test_folder_and_zip_are_valid(self):
        self.assert_valid(ADDON / "chandelier")
        self.assert_valid(self.zip)

    def test_a_fault_would_be_found(self):
        broken = self.folder / "broken" / "chandelier"
        broken.mkdir(parents=True)
        (broken / "__init__.py").touch()
        manifest = (ADDON / "chandelier" / "blender_manifest.toml").read_text()
        (broken / "blender_manifest.toml").write_text(manifest.replace('id = "chandelier"', 'id = "no id"'))
        with self.assertRaisesRegex(AssertionError, "id"):
            self.assert_valid(broken)

    def test_the_installed_zip_works(self):
        self.run_blender("--command", "extension", "install-file", "-r", "user_default", "-e", self.zip)
        self.assertTrue((self.folder / "extensions" / "user_default" / "chandelier" / "LICENSE").is_file())
        self.assertIn("chandelier", self.run_blender("--command", "extension", "list"))
        said = self.run_blender("--background", "--python-exit-code", "3", "--python-expr", IS_INSTALLED)
        self.assertIn(f"library: {self.folder}/extensions/user_default/chandelier/bin/{LIBRARY.name}", said)
        for file, case in (("install_tests.py", "Kept"), ("gltf_tests.py", "Written"), ("preview_tests.py", "Preview")):
            self.run_blender("--background", "--python-exit-code", "3", "--python", HERE / "in_blender" / "bootstrap.py", "--",
                             file, case)


if __name__ == "__main__":
    program = unittest.main(exit=False)
    sys.exit(SKIPPED if program.result.skipped and not program.result.testsRun else not program.result.wasSuccessful())
