# SPDX-License-Identifier: Apache-2.0
# What the programs say to someone who has the wrong file, no driver, or does not know the keys.
import gzip
import os
import re
import shlex
import struct
import subprocess
import unittest

from play_tool import BAKE, PLAY, SMALL, SOURCE, PlayTest, main

INSPECT = os.environ["CHANDELIER_INSPECT"]
SCENE = SOURCE / "examples" / "cmake_project" / "room.gltf"


class Words(PlayTest):
    def said(self, program, *arguments, env=None):
        """The one line of a program that fails, without its beginning."""
        done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder, env=env, timeout=120)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertRegex(done.stderr, r"\Achandelier-\w+: error: [^\n]+\n\Z")
        return done.stderr.split(": error: ", 1)[1].rstrip("\n")

    def file(self, name, content):
        path = self.folder / name
        path.write_bytes(content)
        return path

    def both_say(self, path, expected):
        """The player and the inspector."""
        self.assertEqual(self.said(PLAY, path, "--output", "x.png"), f"{path}: {expected}")
        self.assertEqual(self.said(INSPECT, path), f"{path}: {expected}")

    def test_a_scene_in_place_of_a_pack_names_the_command_that_bakes_it(self):
        for name, content, kind in (("a.glb", self.pack.with_suffix(".glb").read_bytes(), "a glTF binary"),
                                    ("its room.gltf", b"\xef\xbb\xbf \n" + SCENE.read_bytes(), "a glTF")):
            path = self.file(name, content)
            said = self.said(PLAY, path)
            self.assertEqual(said, self.said(INSPECT, path))
            head, command = said.split("make a pack of it with ")
            self.assertEqual(head, f"{path}: not a Chandelier pack, but {kind}: ")
            self.assertEqual(shlex.split(command), ["chandelier-bake", str(path), "-o", str(path.with_suffix(".chandelier"))])
        # The command is right as it stands.
        subprocess.run([BAKE, *shlex.split(self.said(PLAY, self.folder / "a.glb").split("with ")[1])[1:], "--quiet"], check=True)
        self.play_well(self.folder / "a.chandelier", "--output", "x.png", *SMALL)

    def test_other_files_are_called_what_they_are(self):
        filler = bytes(100)
        for name, content, kind in (("a.blend", b"BLENDER-v304" + filler, "a Blender file: export glTF from Blender"),
                                    ("b.blend", gzip.compress(os.urandom(200)), "a Blender file: export glTF from Blender"),
                                    ("c.blend", b"\x28\xb5\x2f\xfd" + filler, "a Blender file: export glTF from Blender"),
                                    ("a.fbx", b"Kaydara FBX Binary  \0" + filler, "an FBX model: open it in Blender and export glTF"),
                                    ("a.usdc", b"PXR-USDC" + filler, "a USD scene: open it in Blender and export glTF"),
                                    ("a.png", b"\x89PNG\r\n\x1a\n" + filler, "an image (PNG)"),
                                    ("a.jpg", b"\xff\xd8\xff\xe0" + filler, "an image (JPEG)"),
                                    ("a.webp", b"RIFF\0\0\0\0WEBPVP8 " + filler, "an image (WebP)"),
                                    ("a.zip", b"PK\3\4" + filler, "a zip archive: unpack it"),
                                    ("a.json", b'{"key": "value"}' + b" " * 100, "a JSON file")):
            with self.subTest(name=name):
                path = self.file(name, content)
                for program in (PLAY, INSPECT):
                    self.assertTrue(self.said(program, path).startswith(f"{path}: not a Chandelier pack, but {kind}"))
                if kind != "a JSON file":
                    self.assertTrue(self.said(BAKE, path, "-o", "x.chandelier").startswith(f"{path}: is not a glTF: it is {kind.split(':')[0]}"))
        path = self.file("x", b"no pack at all" * 10)
        self.both_say(path, "not a Chandelier pack (it begins with 6e 6f 20 70 61 63 6b 20)")

    def test_packs_of_other_versions_say_which_is_older(self):
        whole = self.pack.read_bytes()
        version = struct.unpack_from("<I", whole, 8)[0]
        for other, says in ((version - 1, "a pack of an older chandelier-bake: bake it again"),
                            (version + 1, "a pack of a newer chandelier-bake: show it with the programs that came with that, or bake it again")):
            path = self.file(f"{other}.chandelier", whole[:8] + struct.pack("<I", other) + whole[12:])
            self.both_say(path, f"{says} (version {other}, this program reads {version})")

    def test_a_pack_in_place_of_a_scene(self):
        self.assertEqual(self.said(BAKE, self.pack, "-o", "x.chandelier"),
                         f"{self.pack}: is not a glTF: it is a Chandelier pack already; chandelier-play shows it, chandelier-inspect lists it")

    def without_drivers(self, **more):
        empty = self.folder / "no_drivers"
        empty.mkdir(exist_ok=True)
        return {**os.environ, "VK_DRIVER_FILES": str(empty), "VK_ICD_FILENAMES": str(empty), **more}

    def test_no_driver_says_which_package_brings_one(self):
        for arguments in ((self.pack, "--output", "x.png"), ("--list-devices",), (self.pack, "--compare", "reference,lightcluster", "--report", "x")):
            said = self.said(PLAY, *arguments, env=self.without_drivers())
            self.assertRegex(said, r"^no Vulkan driver on this machine; on Debian: apt install mesa-vulkan-drivers")

    def test_no_loader_says_which_package_brings_one(self):
        for name in ("libvulkan.so.1", "libvulkan.so"):
            (self.folder / name).write_bytes(b"")  # found first, and no library
        env = {**os.environ, "LD_LIBRARY_PATH": str(self.folder)}
        said = self.said(PLAY, self.pack, "--output", "x.png", env=env)
        self.assertRegex(said, r"^no Vulkan loader \(libvulkan.so.1\) on this machine; on Debian: apt install libvulkan1 mesa-vulkan-drivers")

    def test_help_and_readme_name_the_same_keys(self):
        told = self.play_well("--help").stdout.split("In the window:\n")[1].split("\n\n")[0].splitlines()
        keys = [re.match(r"  (\S.*?)  +(\S.*)$", line).groups() for line in told]
        self.assertIn(("Esc", "quit"), keys)
        readme = (SOURCE / "runtime" / "player" / "README.md").read_text().split("## Keys\n")[1].split("\n## ")[0]
        self.assertEqual(re.findall(r"^\| ([^|]+?) \| ([^|]+?) \|$", readme, re.MULTILINE)[1:], keys)


if __name__ == "__main__":
    main()
