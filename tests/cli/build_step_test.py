# SPDX-License-Identifier: Apache-2.0
"""chandelier-bake as a step of a build: report, depfile, progress, the same bytes each time."""
import json
import os
import re
import shutil
import subprocess
import time

import jsonschema

from bake_tool import BAKE, INSPECT, SOURCE, BakeTool, main, without_slow_passes

EVERYTHING = SOURCE / "tests" / "fuzz" / "corpus" / "import" / "everything.gltf"


class Report(BakeTool):
    def test_it_follows_its_schema_and_tells_the_truth(self):
        scene, rig = self.room()
        pack, report = self.bake(scene, rig, "--batch-triangles", "64", "--cache", self.folder / "cache")
        schema = json.loads((SOURCE / "schemas" / "bake_report.schema.json").read_text())
        jsonschema.Draft7Validator.check_schema(schema)
        jsonschema.validate(report, schema)
        self.assertEqual(report["pack_bytes"], len(pack))
        self.assertEqual(report["inputs"], [str(scene), str(rig)])
        beside = scene.parent
        self.assertEqual(set(report["files_read"]),
                         {str(beside / name) for name in ("room.gltf", "lamps.gltf", "room.bin", "tiles.png")})
        self.assertEqual((report["triangles"], report["instanced_triangles"]), (12, 12))
        self.assertEqual((report["images"], report["lights"]), (1, 3))
        self.assertEqual(report["settings"]["batch-triangles"], "64")
        self.assertEqual(report["settings"]["range-threshold"], "0.05")
        self.assertGreater(report["peak_memory_bytes"], 1_000_000)
        names = [each["name"] for each in report["passes"]]
        self.assertEqual((names[0], names[-1]), ("import", "sync"))
        self.assertLessEqual(sum(each["ms"] for each in report["passes"] if "geometry" not in each["name"]),
                             report["seconds"] * 1000 + 1)
        version = re.search(r"project\(Chandelier VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text()).group(1)
        self.assertEqual(report["version"], version)

    def test_version(self):
        done = self.run_bake("--version")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertRegex(done.stdout, r"^chandelier-bake \d+\.\d+\.\d+\n$")

    def test_a_dash_is_stdout_and_nothing_else_is_there(self):
        done = self.run_bake(*self.room(), "-o", self.pack, "--json", "-")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["output"], str(self.pack))

    def test_warnings_are_in_it(self):
        scene, _ = self.room()
        gltf = json.loads(scene.read_text())
        gltf["extensionsUsed"] = ["KHR_nothing_at_all"]
        scene.write_text(json.dumps(gltf))
        _, report = self.bake(scene)
        self.assertEqual(len(report["warnings"]), 1)
        self.assertIn("KHR_nothing_at_all", report["warnings"][0])

    def test_a_device_or_a_pipe_may_take_it(self):
        done = self.run_bake(*self.room(), "-o", self.pack, "--json", "/dev/null", "--quiet")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        done = self.run_bake(*self.room("again"), "-o", self.pack, "--json", "/dev/stdout")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["output"], str(self.pack))
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        reader = subprocess.Popen(["cat", pipe], stdout=subprocess.PIPE, text=True)
        done = self.run_bake(*self.room("third"), "-o", self.pack, "--json", pipe)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(reader.communicate()[0])["output"], str(self.pack))
        self.assertTrue(pipe.is_fifo())

    def test_what_cannot_be_told_fails_and_leaves_the_older_pack(self):
        scene, rig = self.room()
        self.pack.write_bytes(b"older")
        with open("/dev/full", "w", encoding="utf-8") as full:
            for arguments, place in (((), "standard output"), (("--json", "-"), "standard output"),
                                     (("--json", "/dev/full"), "/dev/full")):
                with self.subTest(arguments=arguments):
                    done = without_slow_passes(subprocess.run([BAKE, scene, rig, "-o", self.pack, *arguments], stdout=full,
                                                              stderr=subprocess.PIPE, text=True))
                    self.assertEqual(done.returncode, 1)
                    self.assertEqual(done.stderr, f"chandelier-bake: error: {place}: cannot write: No space left on device\n")
                    self.assertEqual(self.pack.read_bytes(), b"older")
        self.assertEqual([name for name in self.names(self.folder) if name.endswith(".tmp")], [])

    def test_a_failed_bake_writes_none(self):
        done = self.run_bake(self.folder / "gone.gltf", "-o", self.pack, "--json", "r.json", "--depfile", "d.d")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(self.names(self.folder), [])

    def test_outputs_are_checked_before_the_bake(self):
        scene, _ = self.room()
        for arguments, says in ((["--json", "no/such/r.json"], "there is no such folder"),
                                (["--json", "x" * 300], "File name too long"),
                                (["--depfile", "/dev/null"], "exists and is not a regular file"),
                                (["--cache", "x" * 300], "cannot make the cache's folder (File name too long)"),
                                (["--depfile", self.pack], "is used for two outputs"),
                                (["--depfile", scene], "the output is one of the inputs"),
                                (["--json", scene.parent / "room.bin"], "the output is one of the inputs")):
            with self.subTest(arguments=arguments):
                before = scene.read_bytes()
                done = self.run_bake(scene, "-o", self.pack, *arguments)
                self.assertEqual((done.returncode, len(done.stderr.splitlines())), (1, 1), done.stderr)
                self.assertIn(says, done.stderr)
                self.assertFalse(self.pack.exists())
                self.assertEqual(scene.read_bytes(), before)


class Usage(BakeTool):
    def test_an_output_with_a_name_that_is_too_long(self):
        scene, _ = self.room()
        done = self.run_bake(scene, "-o", "x" * 300)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^chandelier-bake: error: x+[^:\n]*: cannot be an output: File name too long\n$")

    def test_an_empty_path_is_wrong_usage(self):
        scene, _ = self.room()
        for option in ("--cache", "--depfile", "--json"):
            for arguments in ((option, ""), (f"{option}=",)):
                done = self.run_bake(scene, "-o", self.pack, *arguments)
                self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
                self.assertIn(option, done.stderr)
                self.assertFalse(self.pack.exists())


class ProgressLines(BakeTool):
    def test_verbose_names_each_pass_and_the_time_that_it_took(self):
        done = self.run_bake(*self.room(), "-o", self.pack, "--verbose")
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = done.stderr.splitlines()
        told = [re.match(r"chandelier-bake: ( *\d+\.\d\d) s: ( *\d+\.\d\d) s for ([\w, ]+)$", line) for line in lines[:-1]]
        passes = [name for line in told for name in line[3].split(", ")]
        self.assertEqual((passes[0], passes[-1]), ("import", "sync"))
        self.assertEqual(len(set(passes)), len(passes))
        self.assertRegex(lines[-1], rf"^chandelier-bake: ( *\d+\.\d\d) s for all {len(passes)} passes$")
        self.assertEqual(len({(len(line[1]), len(line[2])) for line in told}), 1, "times are below each other")
        # What took nothing has no line of its own: none stands beside another such.
        nothing = [float(line[2]) < 0.01 and "," not in line[3] for line in told]
        self.assertNotIn((True, True), zip(nothing, nothing[1:]))

    def test_verbose_and_quiet_is_wrong_usage(self):
        self.assertEqual(self.run_bake(*self.room(), "-o", self.pack, "--verbose", "--quiet").returncode, 2)

    def test_a_terminal_is_left_clean(self):
        """Whatever was rewritten there, the last thing is the end of a line that was erased."""
        try:
            master, slave = os.openpty()
        except OSError as error:
            self.skipTest(f"no terminal to be had ({error})")
        done = subprocess.run([BAKE, *self.room(), "-o", self.pack], stdout=subprocess.PIPE, stderr=slave, cwd=self.folder)
        os.close(slave)
        os.set_blocking(master, False)
        try:
            shown = os.read(master, 65536).decode()
        except (BlockingIOError, OSError):  # nothing, or the terminal's end
            shown = ""
        os.close(master)
        self.assertEqual(done.returncode, 0)
        self.assertNotIn("\n", shown)
        self.assertTrue(shown == "" or shown.endswith("\r\x1b[K"), repr(shown))


class SameBytes(BakeTool):
    def assert_same_bytes(self, *inputs):
        """`inputs`: files and options."""
        first, _ = self.bake(*inputs, "--threads", "1")
        for threads in ("1", "2", "4", "0"):
            again, report = self.bake(*inputs, "--threads", threads)
            self.assertTrue(first == again, f"other bytes with --threads {threads}")
            if threads != "0":
                self.assertEqual(report["threads"], int(threads))

    def test_examples(self):
        for name in ("cornell", "restaurant", "atrium"):
            with self.subTest(name=name):
                self.assert_same_bytes(self.example(name))

    def test_mirrored_and_animated(self):
        self.assert_same_bytes(EVERYTHING)

    def test_compressed(self):
        self.assert_same_bytes(self.example("restaurant"), "--compress")
        self.assert_same_bytes(EVERYTHING, "--compress")

    def test_clipped_to_voxels(self):
        self.assert_same_bytes(self.example("restaurant"), "--voxel-large", "clip")
        self.assert_same_bytes(EVERYTHING, "--voxel-large", "clip")

    def test_classroom(self):
        self.assert_same_bytes(self.data("scenes/classroom/classroom.gltf"))


class Options(BakeTool):
    def inspect(self):
        done = subprocess.run([INSPECT, self.pack, "--json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_compress_keeps_all_in_fewer_bytes(self):
        scene = self.example("restaurant")
        raw, _ = self.bake(scene)
        plain = self.inspect()
        small, report = self.bake(scene, "--compress")
        packed = self.inspect()
        self.assertEqual(report["settings"]["compress"], "true")
        self.assertLess(len(small) * 2, len(raw))
        self.assertEqual({each["codec"] for each in plain["sections"]}, {"raw"})
        self.assertLess({"columns", "zstd"}, {each["codec"] for each in packed["sections"]} | {"triangles", "raw"})
        self.assertEqual({each["codec"] for each in plain["images"]}, {"raw"})
        self.assertIn("zstd", {each["codec"] for each in packed["images"]})
        for report in (plain, packed):
            del report["size_bytes"]
            report["sections"] = [each for each in report["sections"] if each["name"] != "image_data"]  # as images are stored
            for part in report["sections"] + report["images"]:
                del part["stored_bytes"], part["codec"]
        self.assertEqual(packed, plain)

    def test_voxel_large_clip_draws_nothing_always(self):
        scene = self.example("restaurant")
        self.bake(scene)
        separate = self.inspect()["voxels"]
        self.bake(scene, "--voxel-large", "clip")
        clip = self.inspect()["voxels"]
        self.assertEqual((separate["mode"], clip["mode"]), ("separate", "clip"))
        self.assertGreater(separate["no_cull_triangles"], 0)
        self.assertEqual(clip["no_cull_triangles"], 0)
        self.assertGreater(clip["occupied"], separate["occupied"])


class Depfile(BakeTool):
    def setUp(self):
        super().setUp()
        odd = self.folder / "odd $names #1"  # everything that needs an escape
        odd.mkdir()
        for name in ("room.gltf", "lamps.gltf", "room.bin", "tiles.png"):
            shutil.copy(SOURCE / "examples" / "cmake_project" / name, odd)
        self.odd = odd
        self.out = self.folder / "the pack #1.chandelier"

    def assert_follows_its_inputs(self, build):
        """`build()` bakes, then does nothing until any file that was read changes."""
        build()
        self.assertTrue(self.out.exists())
        for name in ("tiles.png", "room.bin", "lamps.gltf", "room.gltf"):
            before = self.out.stat().st_mtime_ns
            build()
            self.assertEqual(self.out.stat().st_mtime_ns, before, "baked again for nothing")
            time.sleep(0.02)  # file systems count time in steps of milliseconds
            (self.odd / name).touch()
            build()
            self.assertGreater(self.out.stat().st_mtime_ns, before, f"not baked again after {name} changed")

    def run_tool(self, *command):
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_ninja(self):
        ninja = str(self.out.name).replace("$", "$$").replace(" ", "$ ")
        (self.folder / "build.ninja").write_text(
            "rule bake\n"
            f"  command = '{BAKE}' 'odd $$names #1/room.gltf' 'odd $$names #1/lamps.gltf' -o '{self.out.name}' --depfile pack.d -q\n"
            "  depfile = pack.d\n"
            "  deps = gcc\n"
            f"build {ninja}: bake\n")
        self.assert_follows_its_inputs(lambda: self.run_tool("ninja"))

    def test_make(self):
        target = self.out.name.replace("#", "\\#").replace(" ", "\\ ")
        (self.folder / "Makefile").write_text(
            f"{target}:\n"
            f"\t'{BAKE}' 'odd $$names #1/room.gltf' 'odd $$names #1/lamps.gltf' -o '{self.out.name}' --depfile pack.d -q\n"
            "-include pack.d\n")
        self.assert_follows_its_inputs(lambda: self.run_tool("make"))
        (self.odd / "tiles.png").rename(self.odd / "gone.png")  # a rule for it is not missed: the bake says what is wrong
        done = subprocess.run(["make"], cwd=self.folder, capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("(tiles.png): no such file", done.stderr)


if __name__ == "__main__":
    main()
