# SPDX-License-Identifier: Apache-2.0
"""Checks the set-up scripts: their syntax, the package list, and what they say where they cannot do their work."""

import os
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
INSTALL = os.path.join(ROOT, "setup", "install.sh")


class Setup(unittest.TestCase):
    def with_path_of(self, commands, script, *arguments):
        """Runs a script where only these commands exist, each the real one."""
        with tempfile.TemporaryDirectory() as folder:
            for command in commands:
                os.symlink(shutil.which(command), os.path.join(folder, command))
            return subprocess.run(["/bin/bash", script, *arguments], env={"PATH": folder}, capture_output=True, text=True)

    def test_scripts_parse(self):
        for script in ("setup/install.sh", "setup/mesa25.sh", "setup/blender4.sh", "setup/blender4_run.sh", ".ci/run"):
            result = subprocess.run(["bash", "-n", os.path.join(ROOT, script)], capture_output=True, text=True)
            self.assertEqual((result.returncode, result.stderr), (0, ""), script)
            self.assertTrue(os.access(os.path.join(ROOT, script), os.X_OK), script)

    def test_package_list_is_in_order(self):
        names = []
        for list_name in ("packages.txt", "packages-bench.txt", "packages-blender4.txt", "packages-fuzz.txt"):
            with open(os.path.join(ROOT, "setup", list_name), encoding="utf-8") as file:
                names += [line.split("#")[0].strip() for line in file]
        names = [name for name in names if name]
        self.assertGreater(len(names), 20)
        self.assertEqual(len(names), len(set(names)), "a package twice")
        for name in names:
            self.assertRegex(name, r"^[a-z0-9][a-z0-9+.-]+$")

    def test_install_refuses_without_apt(self):
        result = self.with_path_of(("dirname", "sed"), INSTALL)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"^setup/install.sh: error: this system has no apt[^\n]*\n$")

    @unittest.skipUnless(shutil.which("dpkg-query"), "no dpkg-query")
    def test_install_without_root_and_sudo_says_what_root_should_run(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy(INSTALL, folder)
            with open(os.path.join(folder, "packages.txt"), "w", encoding="utf-8") as file:
                file.write("# a comment\ndpkg  # installed\nchandelier-no-such-package\n")
            id_of_user = os.path.join(folder, "id")
            with open(id_of_user, "w", encoding="utf-8") as file:
                file.write("#!/bin/sh\necho 1000\n")
            os.chmod(id_of_user, 0o755)
            for command in ("dirname", "sed", "dpkg-query", "apt-get"):
                os.symlink(shutil.which(command), os.path.join(folder, command))
            result = subprocess.run(["/bin/bash", os.path.join(folder, "install.sh")], env={"PATH": folder}, capture_output=True,
                                    text=True)
        self.assertEqual(result.returncode, 1)
        self.assertIn("installing 1 of 2 Debian packages: chandelier-no-such-package", result.stdout)
        self.assertIn("no sudo; as root run: apt-get install --no-install-recommends chandelier-no-such-package", result.stderr)

    def test_mesa25_says_what_it_lacks(self):
        with tempfile.TemporaryDirectory() as folder:
            result = self.with_path_of(("mkdir", "find", "dirname"), os.path.join(ROOT, "setup", "mesa25.sh"), folder)
        self.assertEqual(result.returncode, 3)
        self.assertEqual(result.stderr, "setup/mesa25.sh: error: Mesa 25 cannot be had: this system has no apt\n")

    def test_blender4_says_what_it_lacks(self):
        with tempfile.TemporaryDirectory() as folder:
            result = self.with_path_of(("mkdir", "dirname", "id"), os.path.join(ROOT, "setup", "blender4.sh"), folder)
        self.assertEqual(result.returncode, 3)
        self.assertRegex(result.stderr, r"^setup/blender4.sh: error: Blender 4.3 cannot be had: no[^\n]+\n$")

    def test_make_demo_builds_only_what_it_runs_and_says_how_far_it_is(self):
        """What make would do, where there is no build yet but for the programs' names."""
        with tempfile.TemporaryDirectory() as build:
            os.mkdir(os.path.join(build, "bin"))
            for program in ("chandelier-bake", "chandelier-play"):
                with open(os.path.join(build, "bin", program), "w", encoding="utf-8"):
                    pass
            done = subprocess.run(["make", "-n", "-C", ROOT, "demo", f"BUILD={build}"], capture_output=True, text=True, check=True)
        lines = [line.strip() for line in done.stdout.splitlines()]
        self.assertEqual([line for line in lines if line.startswith("cmake --build")],
                         ["cmake --build --preset release --target chandelier-bake chandelier-play"])
        self.assertIn("cmake --preset release", lines)
        self.assertEqual([line.split(":")[1] for line in lines if line.startswith("demo: step")],
                         [f" step {step} of 4" for step in (2, 3, 4)])  # make prints what it would say of the first
        self.assertTrue(any(line.startswith('echo "demo: step 1 of 4') for line in lines))
        for name in ("atrium", "cornell", "restaurant"):
            (rendered,) = [number for number, line in enumerate(lines) if f"--report {build}/demo/{name}" in line]
            self.assertTrue(any(f"demo: pictures of {name}: " in line and f"/demo/{name}" in line
                                for line in lines[rendered:rendered + 3]), done.stdout)

    def test_make_help_names_every_target(self):
        with open(os.path.join(ROOT, "Makefile"), encoding="utf-8") as file:
            targets = set(re.search(r"^\.PHONY: (.*)$", file.read(), re.MULTILINE).group(1).split()) - {"help", "setup"}
        shown = subprocess.run(["make", "-s", "-C", ROOT, "help"], capture_output=True, text=True, check=True).stdout
        self.assertEqual(targets, set(re.findall(r"^make ([a-z0-9-]+)", shown, re.MULTILINE)))


if __name__ == "__main__":
    unittest.main()
