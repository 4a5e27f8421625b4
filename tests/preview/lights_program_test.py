# SPDX-License-Identifier: Apache-2.0
"""chandelier-lights as a user types it, the library as a loader sees it."""

import ctypes
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import jsonschema

SCHEMAS = {name: json.loads((pathlib.Path(os.environ["CHANDELIER_SOURCE"]) / "schemas" / f"light_{name}.schema.json").read_text())
           for name in ("request", "selection")}
LIGHTS, LIBRARY = os.environ["CHANDELIER_LIGHTS"], os.environ["CHANDELIER_PREVIEW_LIBRARY"]
NEEDED = {"libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}


def lights(*arguments, stdin=""):
    return subprocess.run([LIGHTS, *arguments], input=stdin, capture_output=True, text=True, timeout=120, check=False)


class Program(unittest.TestCase):
    def selection(self, request):
        jsonschema.Draft202012Validator(SCHEMAS["request"]).validate(request)
        done = lights(stdin=json.dumps(request))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        selection = json.loads(done.stdout)
        jsonschema.Draft202012Validator(SCHEMAS["selection"]).validate(selection)
        return selection

    def assert_refused(self, text, because):
        done = lights(stdin=text)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertRegex(done.stderr, r"\Achandelier-lights: error: standard input: [^\n]+\n\Z")
        self.assertIn(because, done.stderr)

    def test_the_examples_of_its_help_work(self):
        text = lights("--help").stdout
        example = re.search(r"Input, every part optional:\n(.*?)\n\nOutput", text, re.DOTALL).group(1)
        example = re.sub(r"(?<=[\],}])   .*$", "", example, flags=re.MULTILINE)  # what each means
        self.assertEqual(self.selection(json.loads(example))["center_of_light"], [1, 1])
        echoed = re.search(r"echo '(.*)'", text).group(1)
        self.assertEqual(self.selection(json.loads(echoed))["center_of_light"], [0, 0, 2])
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "lights.json"
            path.write_text(echoed)
            self.assertEqual(lights(str(path)).stdout, lights(stdin=echoed).stdout)

    def test_settings_have_the_schemas_defaults(self):
        known = SCHEMAS["request"]["properties"]["settings"]["properties"]
        defaults = {name: page["default"] for name, page in known.items() if "default" in page}
        self.assertEqual(defaults.keys(), known.keys())
        lights = {"position": [[0.3 * number, 0, 0] for number in range(9)]}
        self.assertEqual(self.selection({"lights": lights}), self.selection({"lights": lights, "settings": defaults}))

    def test_everything_has_a_default(self):
        self.assertEqual(self.selection({})["bill"]["shadow_maps"], 0)
        bill = self.selection({"lights": {"position": [[0, 0, 0]]}})["bill"]
        self.assertEqual((bill["shadow_maps"], bill["shadow_views"], bill["shadow_bytes"], bill["d_init_m"]),
                         (1, 6, 6 << 20, 0.5))

    def test_a_range_of_zero_is_derived_with_a_warning(self):
        request = {"lights": {"position": [[0, 0, 0], [1, 0, 0], [2, 0, 0]], "type": ["point", "point", "directional"],
                              "direction": [[0, -1, 0]] * 3, "range_m": [0, 5, 0]}}
        done = lights(stdin=json.dumps(request))
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r"\Achandelier-lights: warning: lights.range_m: 0 is taken as none[^\n]* \(1 of 3\)\n\Z")
        request["lights"]["range_m"][0] = None
        self.assertEqual(self.selection(request), json.loads(done.stdout))

    def test_bad_input_is_one_line_with_its_place(self):
        place = {"position": [[0, 0, 0], [1, 0, 0]]}
        for request, because in (
                ([], "standard input: is not an object ([])"), ({"light": {}}, "light: is none of lights, settings, camera"),
                ({"lights": [1]}, "lights: is not an object"), ({"lights": {"positions": []}}, "lights.positions: is none of"),
                ({"lights": {"type": ["point"]}}, "lights.position: is missing"),
                ({"lights": {"position": [[0, 0]]}}, "lights.position[0]: is not three numbers ([0,0])"),
                ({"lights": {"position": [[0, 0, "x"]]}}, 'lights.position[0]: is not a number ("x")'),
                ({"lights": {"position": [[0, 0, 1e39]]}}, "lights.position[0]: is too large"),
                ({"lights": place | {"type": ["point"]}}, "lights.type: has not one value for each of 2 lights (1)"),
                ({"lights": place | {"type": ["point", "area"]}}, "lights.type[1]: is none of point, spot, directional"),
                ({"lights": place | {"priority": [1, 256]}}, "lights.priority[1]: is not from 0 to 255 (256)"),
                ({"lights": place | {"priority": [1, 1.5]}}, "lights.priority[1]: is not a whole number (1.5)"),
                ({"lights": place | {"dynamic": [1, 0]}}, "lights.dynamic[0]: is not true or false (1)"),
                ({"lights": place | {"group": [0, 1 << 40]}}, "lights.group[1]: is not from -1 to 2147483647"),
                ({"lights": place | {"range_m": [1, -2]}}, "light 1, range_m: is not from 0"),
                ({"settings": {"d_init": 3}}, "settings.d_init: is none of select"),
                ({"settings": {"distance_scaling": "shrink"}}, "settings.distance_scaling: is none of grow, paper-formula, none"),
                ({"settings": {"face_size_px": -1}}, "settings.face_size_px: is not from 0"),
                ({"settings": {"face_size_px": 8}}, "face-size must be from 16 to 16384 texels"),
                ({"camera": {"size_px": [0, 5]}}, "camera.size_px: is not from 1"),
                ({"camera": {"forward_ws": [0, 0, 0]}}, "camera, forward_ws: has no direction"),
                ({"camera": {"fov": 1}}, "camera.fov: is none of eye_ws")):
            with self.subTest(because):
                self.assert_refused(json.dumps(request), because)
                schema = jsonschema.Draft202012Validator(SCHEMAS["request"])
                known_to_both = not re.search("too large|one value for each|has no direction|is missing", because)
                self.assertNotEqual(schema.is_valid(request), known_to_both)

    def test_what_is_no_json_is_refused(self):
        for text, because in (("", "parse error"), ("{", "parse error"), ('{"lights": NaN}', "parse error"),
                              ("[" * 100000, "nested too deeply"), ('{"a":' * 50 + "1" + "}" * 50, "nested too deeply"),
                              ("\x00\x01\n\n{", "parse error"), ('{"\\n": 1}', ": is none of")):
            with self.subTest(text[:20]):
                self.assert_refused(text, because)

    def test_wrong_usage(self):
        self.assertEqual(lights("--sideways").returncode, 2)
        self.assertEqual(lights("a", "b").returncode, 2)
        self.assertEqual(lights("--version").returncode, 0)

    def test_errors_name_the_file(self):
        with tempfile.TemporaryDirectory() as folder:
            broken, wrong, empty = (pathlib.Path(folder) / name for name in ("broken.json", "wrong.json", "empty.json"))
            broken.write_text('{"lights": ')
            wrong.write_text('{"settings": {"d_init_m": "far"}}')
            empty.touch()
            for path, because in (("/nowhere/lights.json", "cannot be opened (No such file or directory)"),
                                  (folder, "cannot be read (Is a directory)"), (broken, "[json.exception.parse_error"),
                                  (empty, "[json.exception.parse_error"), (wrong, 'settings.d_init_m: is not a number ("far")')):
                with self.subTest(path):
                    done = lights(str(path))
                    self.assertEqual((done.returncode, done.stdout), (1, ""))
                    self.assertTrue(done.stderr.startswith(f"chandelier-lights: error: {path}: {because}"), done.stderr)
                    self.assertEqual(done.stderr.count("\n"), 1)

    def test_output_that_cannot_be_written(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full")
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([LIGHTS], input="{}", stdout=full, stderr=subprocess.PIPE, text=True, timeout=120, check=False)
        self.assertEqual((done.returncode, done.stderr),
                         (1, "chandelier-lights: error: cannot write to standard output\n"))


class Library(unittest.TestCase):
    """As it is carried into programs with a C++ library of their own."""

    def setUp(self):
        if os.environ.get("CHANDELIER_SANITIZE"):
            self.skipTest("a build with sanitizers")

    def test_needs_nothing_but_glibc(self):
        dynamic = subprocess.run(["readelf", "-d", LIBRARY], capture_output=True, text=True, check=True).stdout
        needed = set(re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic))
        self.assertTrue(needed and needed <= NEEDED, needed)

    def test_shows_its_own_functions_alone(self):
        symbols = subprocess.run(["nm", "-D", "--defined-only", LIBRARY], capture_output=True, text=True, check=True).stdout
        names = {line.split()[-1] for line in symbols.splitlines()}
        self.assertEqual(names, {"chandelier_preview_abi", "chandelier_preview_defaults", "chandelier_preview_select"})

    def test_loads_as_it_is(self):
        library = ctypes.CDLL(LIBRARY)
        self.assertEqual(library.chandelier_preview_abi(), 2)
        self.assertEqual(library.chandelier_preview_select(None, None, None, None, None, 0), 1)


if __name__ == "__main__":
    unittest.main()
