# SPDX-License-Identifier: Apache-2.0
# generate.py refuses pages that would not give one layout everywhere, and its hash follows the layout only.
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import pack_schema

SCHEMAS = Path(os.environ["CHANDELIER_SCHEMAS"])
sys.path.insert(0, str(SCHEMAS))
import generate  # noqa: E402


def page(body):
    return f'<schema name="pack" namespace="n" version="1"><constant name="none" type="u32" value="1"/>{body}</schema>'


def record(fields, extra=""):
    return page(f'<record name="R" {extra}>{fields}</record>')


# (what is wrong, page, part of the message)
REFUSED = [
    ("hole", record('<field name="a" type="u32"/><field name="b" type="u64"/>'), "R.b: 4 bytes of padding before it"),
    ("hole at the end", record('<field name="a" type="u64"/><field name="b" type="u32"/>'),
     "R: 4 bytes of padding at the end"),
    ("hole after bytes", record('<field name="a" type="u8" count="3"/><field name="b" type="f32"/>'),
     "R.b: 1 bytes of padding before it"),
    ("u64 on the GPU", record('<field name="a" type="u64"/>', 'gpu="yes"'), "R.a: a GPU record cannot hold it (u64)"),
    ("unknown type", record('<field name="a" type="f64"/>'), "R.a: unknown type (f64)"),
    ("unknown attribute", record('<field name="a" type="u32" maximum="2"/>'), "R.a: unknown attribute (maximum)"),
    ("twice", record('<field name="a" type="u32"/><field name="a" type="u32"/>'), "R.a: declared twice"),
    ("a word of GLSL", record('<field name="filter" type="u32"/>'), "the name is a reserved word (filter)"),
    ("a method of GLSL", record('<field name="length" type="u32"/>'), "the name is a reserved word (length)"),
    ("bad name", record('<field name="aB" type="u32"/>'), "the name does not match"),
    ("unknown enum", record('<field name="a" type="u32" enum="E"/>'), "R.a: no such enum (E)"),
    ("unknown section", record('<field name="a" type="u32" index="s"/>'), "R.a: no such section (s)"),
    ("early string", record('<field name="a" type="string"/>'), "R.a: StringRef is not declared before it"),
    ("enum with a gap", page('<enum name="E"><value name="a" value="0"/><value name="b" value="2"/></enum>'),
     "E.b: values must count up from 0 (2)"),
    ("kinds descend", page('<record name="R"><field name="a" type="u32"/></record>'
                           '<section kind="2" name="a" record="R"/><section kind="1" name="b" record="R"/>'),
     "kinds must ascend"),
    ("not XML", "<schema", "error: "),
]

ANSWER = '<answer name="a">what it does</answer>'
STAGE = f'<stage name="s" question="which?" default="a">{ANSWER}</stage>'
PRESET = '<preset name="p">the first</preset>'
SETTING = 'name="x" type="f32" default="1" least="0" most="2"'

# The same of recipes.
REFUSED += [
    ("stage without question", page(f'<stage name="s" default="a">{ANSWER}</stage>{PRESET}'), "s: has no question"),
    ("default that is no answer", page(f'<stage name="s" question="q" default="b">{ANSWER}</stage>{PRESET}'),
     "s: the default is none of its answers (b)"),
    ("answer twice", page(f'<stage name="s" question="q" default="a">{ANSWER}{ANSWER}</stage>{PRESET}'),
     "s: two answers have one name"),
    ("answer without text", page('<stage name="s" question="q" default="a"><answer name="a"/></stage>'),
     "s.a: has no text that explains it"),
    ("answer that C++ keeps", page('<stage name="s" question="q" default="a"><answer name="inline">x</answer></stage>'),
     "s.inline: the name is a reserved word (inline)"),
    ("stages without preset", page(STAGE), "presets: there is none"),
    ("preset of no stage", page(f'{STAGE}<preset name="p" t="a">x</preset>'), "p: there is no such stage (t)"),
    ("preset of no answer", page(f'{STAGE}<preset name="p" s="b">x</preset>'), "p: s has no such answer (b)"),
    ("stage twice", page(STAGE + STAGE + PRESET), "members of a recipe: two have one name (s)"),
    ("setting of no type", page('<setting name="x" type="f64" default="1"/>'), "x: a setting is one of f32, u32, u64"),
    ("default out of limits", page(f'<setting {SETTING.replace("1", "3")}/>'), "x: the default is not within its limits (3)"),
    ("one limit", page(f'<setting {SETTING.replace("most", "min")}/>'), "x: unknown attribute (min)"),
    ("no limits", page('<setting name="x" type="f32" default="1"/>'), "x: needs limits"),
    ("no default", page('<setting name="x" type="u32"/>'), "x: either it is optional or it has a default (None)"),
]


class PackGenerator(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name) / "page.xml"

    def tearDown(self):
        self.folder.cleanup()

    def schema_of(self, text):
        self.path.write_text(text, encoding="utf-8")
        return generate.Schema(self.path)

    def test_bad_pages_are_refused_in_one_line(self):
        for what, text, message in REFUSED:
            with self.subTest(what):
                self.path.write_text(text, encoding="utf-8")
                out = Path(self.folder.name) / "out"
                run = subprocess.run([sys.executable, SCHEMAS / "generate.py", "--schema", self.path, "--out", out],
                                     capture_output=True, text=True)
                self.assertEqual((run.returncode, run.stderr.count("\n")), (1, 1), run.stderr)
                self.assertIn(message, run.stderr)
                self.assertFalse(out.exists())

    def test_the_hash_follows_the_layout_only(self):
        text = (SCHEMAS / "pack.xml").read_text(encoding="utf-8")
        before = self.schema_of(text).hash
        for old, new in (("Which texels.", ""), ("Linear RGBA.", "Linear."), ('max="31"', 'max="30"')):
            self.assertEqual(self.schema_of(text.replace(old, new)).hash, before)
        for old, new in (('name="uv1_mask"', 'name="uv_mask"'), ('name="nearest" value="0"', 'name="near" value="0"'),
                         ('<field name="yfov_rad" type="f32"', '<field name="yfov_rad" type="u32"'),
                         ('kind="37"', 'kind="38"')):
            self.assertIn(old, text)
            self.assertNotEqual(self.schema_of(text.replace(old, new)).hash, before, old)

    def test_a_recipes_table_becomes_enums_defaults_and_glsl(self):
        self.path.write_text(page(f"""
            <stage name="two-words" question="which?" default="b-c">{ANSWER}<answer name="b-c">more</answer></stage>
            <setting {SETTING} option="x" unit="m">length</setting>{PRESET}<preset name="q" two-words="a">other</preset>"""))
        out = Path(self.folder.name) / "out"
        subprocess.run([sys.executable, SCHEMAS / "generate.py", "--schema", self.path, "--out", out], check=True)
        header, shader = (out / "recipe_schema.h").read_text(), (out / "pack_schema.glsl").read_text()
        for text in ("enum class TwoWords", "b_c = 1,", "TwoWords two_words = TwoWords::b_c;", "float x = 1.0f;",
                     '"from 0 to 2 m"', '{"q", "other", Recipe{.two_words = TwoWords::a}}'):
            self.assertIn(text, header)
        self.assertIn("const uint TWO_WORDS_B_C = 1u;", shader)

    def test_echo_shaders_compile(self):
        generated = Path(pack_schema.__file__).parent
        shaders = sorted((generated / "echo").glob("*.comp"))
        self.assertGreater(len(shaders), 10)
        for shader in shaders:
            run = subprocess.run(["glslangValidator", "--quiet", "-V", "--target-env", "vulkan1.3", f"-I{generated}",
                                  shader, "-o", Path(self.folder.name) / "echo.spv"], capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, f"{shader.name}: {run.stdout}")

    def test_a_stale_format_page_is_refused(self):
        stale = Path(self.folder.name) / "FORMAT.md"
        stale.write_text((SCHEMAS / "FORMAT.md").read_text(encoding="utf-8") + "x", encoding="utf-8")
        run = subprocess.run([sys.executable, SCHEMAS / "generate.py", "--schema", SCHEMAS / "pack.xml", "--check-page",
                              stale], capture_output=True, text=True)
        self.assertEqual(run.returncode, 1)
        self.assertIn("run generate.py", run.stderr)


if __name__ == "__main__":
    unittest.main()
