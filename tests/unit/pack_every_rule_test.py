# SPDX-License-Identifier: Apache-2.0
# Breaks every rule of every field that the schema page declares, with right checksums; opening must name the field.
import os
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pack_schema
import xxhash

PAGE = ET.parse(Path(os.environ["CHANDELIER_SCHEMAS"]) / "pack.xml").getroot()
RECORDS = {r.get("name"): r.findall("field") for r in PAGE.findall("record")}
ENUMS = {e.get("name"): len(e.findall("value")) for e in PAGE.findall("enum")}
FLOATS = {"f32", "vec2", "vec3", "vec4", "dvec3"}


def bad_values(field, lengths):
    """{rule: a value that breaks it} of one field."""
    kind, low, high = field.get("type"), field.get("min"), field.get("max")
    bad = {}
    if kind in FLOATS:
        bad |= {"finite": np.nan, "not infinite": np.inf, "not minus infinite": -np.inf}
    if low and (kind in FLOATS or int(low) > 0):
        bad["min"] = float(low) - 1
    # A length above its maximum is past its section first; pack_rules_test.cpp has that one.
    if high and field.get("name") not in lengths:
        bad["max"] = float(high) * 1.01 + 1
    if field.get("enum"):
        bad["enum"] = ENUMS[field.get("enum")]
    if field.get("index"):
        bad["index"] = 60000
        if field.get("optional") != "yes":
            bad["not none"] = pack_schema.NONE
    if field.get("run"):
        bad |= {"run": 60000, "run wraps": pack_schema.NONE}
    return bad


def ruled_fields(record):
    """(fields around it, field, names of its record's lengths); of a string, StringRef's fields."""
    for field in RECORDS.get(record, []):
        if field.get("type") == "string":
            for inner in RECORDS["StringRef"]:
                yield (field.get("name"),), inner, {"size_bytes"}
        else:
            yield (), field, {f.get("length") for f in RECORDS[record]}


def scalars(field):
    """(path, index) of every scalar of a field in a section's first record."""
    axes = {"vec2": "xy", "vec3": "xyz", "dvec3": "xyz", "vec4": "xyzw"}.get(field.get("type"), "")
    for element in range(int(field.get("count", "1"))):
        array = field.get("count") is not None
        path, at = f"[{element}]" if array else "", (0, element) if array else (0,)
        for axis, letter in enumerate(axes):
            yield f"{path}.{letter}", at + (axis,)
        if not axes:
            yield path, at


class EveryRule(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name) / "a.pack"
        subprocess.run([os.environ["CHANDELIER_WRITE_SAMPLE"], self.path], check=True)
        self.bytes = np.fromfile(self.path, np.uint8)

    def tearDown(self):
        self.folder.cleanup()

    def write_changed(self, section, fields, at, value):
        """Writes the pack with one scalar changed and all checksums right."""
        data = self.bytes.copy()
        header = data[:pack_schema.FileHeader.itemsize].view(pack_schema.FileHeader)
        end = pack_schema.FileHeader.itemsize + int(header["section_count"][0]) * pack_schema.SectionEntry.itemsize
        table = data[pack_schema.FileHeader.itemsize:end]
        for entry in table.view(pack_schema.SectionEntry):
            stored = data[int(entry["offset_bytes"]):int(entry["offset_bytes"] + entry["size_bytes"])]
            name, dtype = pack_schema.SECTIONS[int(entry["kind"])]
            if name == section:
                array = stored.view(dtype)
                for field in fields:
                    array = array[field]
                array[at] = value
            entry["checksum"] = xxhash.xxh3_64_intdigest(stored)
        header["table_checksum"] = xxhash.xxh3_64_intdigest(table)
        data.tofile(self.path)

    def check(self, section, fields, scalar, rule):
        at = "" if section == "bake_info" else "[0]"
        start = f"chandelier-inspect: error: {self.path}: {section}{at}.{'.'.join(fields)}{scalar}: "
        run = subprocess.run([os.environ["CHANDELIER_INSPECT"], self.path], capture_output=True, text=True)
        self.assertEqual(run.returncode, 1, f"{start}{rule} was not checked")
        self.assertTrue(run.stderr.startswith(start), f"{rule}: {run.stderr!r} does not start {start!r}")
        self.assertEqual(run.stderr.count("\n"), 1)

    def test_every_rule_of_every_field(self):
        tried = 0
        for page_section in PAGE.findall("section"):
            section = page_section.get("name")
            for outer, field, lengths in ruled_fields(page_section.get("record")):
                fields = outer + (field.get("name"),)
                for rule, value in bad_values(field, lengths).items():
                    for scalar, at in scalars(field):
                        self.write_changed(section, fields, at, value)
                        self.check(section, fields, scalar, rule)
                        tried += 1
        self.assertGreater(tried, 250)


if __name__ == "__main__":
    unittest.main()
