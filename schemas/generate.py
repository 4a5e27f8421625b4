#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
# Turns a schema (pack.xml, frame.xml) into C++, GLSL, Python and the format page. README.md says how to add a field.
"""Generate code from a schema page.

  generate.py --schema pack.xml --out DIR              write everything the build needs into DIR
  generate.py --schema pack.xml --out DIR --list       only name the files that would be written, one a line
  generate.py --schema pack.xml --page FORMAT.md       write the page for readers: of frame.xml it is RECIPES.md
  generate.py --schema pack.xml --check-page FORMAT.md     fail unless that page is current
"""

import argparse
import hashlib
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import jinja2

from recipe_table import RecipeTable
from schema_page import CAMEL, SNAKE, SchemaError, check_attributes, check_name, comment, upper

# name: C++ type, GLSL type, numpy code, bytes, alignment, components
TYPES = {
    "u8": ("uint8_t", None, "u1", 1, 1, 1),
    "u32": ("uint32_t", "uint", "<u4", 4, 4, 1),
    "u64": ("uint64_t", None, "<u8", 8, 8, 1),
    "f32": ("float", "float", "<f4", 4, 4, 1),
    "vec2": ("glm::vec2", "vec2", "<f4", 8, 4, 2),
    "vec3": ("glm::vec3", "vec3", "<f4", 12, 4, 3),
    "vec4": ("glm::vec4", "vec4", "<f4", 16, 4, 4),
    "dvec3": ("glm::dvec3", None, "<f8", 24, 8, 3),
    "string": ("StringRef", "StringRef", None, 8, 4, 1),
}
FLOATS = {"f32": "f32", "vec2": "f32", "vec3": "f32", "vec4": "f32", "dvec3": "f64"}  # type: that of a component
class Field:
    def __init__(self, element, record):
        self.name = check_name(element.get("name"), SNAKE, record)
        place = f"{record}.{self.name}"
        check_attributes(element, place)
        self.comment, self.type = comment(element), element.get("type")
        if self.type not in TYPES:
            raise SchemaError(f"{place}: unknown type ({self.type})")
        self.cpp, self.glsl, self.numpy, size, self.align, self.components = TYPES[self.type]
        self.count = int(element.get("count", "1"))
        self.size = size * self.count
        self.unit, self.enum = element.get("unit", ""), element.get("enum")
        self.min, self.max = element.get("min"), element.get("max")
        self.index, self.optional = element.get("index"), element.get("optional") == "yes"
        self.run, self.length = element.get("run"), element.get("length")
        if self.enum:
            self.cpp = self.enum
        self.cpp_base = self.cpp
        if self.count > 1:
            self.cpp = f"std::array<{self.cpp}, {self.count}>"
        if (self.enum or self.index) and self.type != "u32":
            raise SchemaError(f"{place}: an enum or index must be a u32 ({self.type})")

    @property
    def default(self):
        if self.optional:
            return " = none"
        if self.type == "string":
            return ""
        return " = {}" if self.count > 1 or self.components > 1 or self.enum else " = 0"

    @property
    def numpy_text(self):
        if self.type == "string":
            return f'("{self.name}", StringRef)'
        shape = [n for n in (self.count, self.components) if n > 1]
        shape_text = "" if not shape else f", {shape[0]}" if len(shape) == 1 else f", {tuple(shape)}"
        return f'("{self.name}", "{self.numpy}"{shape_text})'

    @property
    def type_text(self):
        return self.type + (f"[{self.count}]" if self.count > 1 else "")

    @property
    def rule_text(self):
        """For FORMAT.md."""
        rules = []
        if self.min is not None:
            rules.append(f"≥ {self.min}")
        if self.max is not None:
            rules.append(f"≤ {self.max}")
        if self.enum:
            rules.append(self.enum)
        if self.index:
            rules.append(f"below the count of {self.index}" + (", or none" if self.optional else ""))
        if self.run:
            rules.append(f"plus {self.length} within {self.run}")
        if self.type == "string":
            rules.append("within strings")
        return ", ".join(rules)


class Record:
    def __init__(self, element, known):
        self.name = check_name(element.get("name"), CAMEL, "record")
        check_attributes(element, self.name)
        self.comment, self.gpu = comment(element), element.get("gpu") == "yes"
        self.fields = [Field(e, self.name) for e in element.findall("field")]
        self.size, self.align = 0, 1
        names = set()
        for field in self.fields:
            self.place(field, known)
            if field.name in names:
                raise SchemaError(f"{self.name}.{field.name}: declared twice")
            names.add(field.name)
        if self.size % self.align:
            raise SchemaError(f"{self.name}: {self.align - self.size % self.align} bytes of padding at the end; "
                              f"add reserved fields ({self.size} bytes)")

    def place(self, field, known):
        place = f"{self.name}.{field.name}"
        if self.size % field.align:
            raise SchemaError(f"{place}: {field.align - self.size % field.align} bytes of padding before it; "
                              f"add a reserved field or reorder (offset {self.size})")
        if self.gpu and not field.glsl:
            raise SchemaError(f"{place}: a GPU record cannot hold it ({field.type})")
        if field.type == "string" and "StringRef" not in known:
            raise SchemaError(f"{place}: StringRef is not declared before it")
        field.offset = self.size
        self.size += field.size
        self.align = max(self.align, field.align)


class Enum:
    def __init__(self, element):
        self.name = check_name(element.get("name"), CAMEL, "enum")
        self.comment = comment(element)
        self.values = [(check_name(e.get("name"), SNAKE, self.name), int(e.get("value")), comment(e))
                       for e in element.findall("value")]
        for number, (name, value, _) in enumerate(self.values):
            if number != value:
                raise SchemaError(f"{self.name}.{name}: values must count up from 0 ({value})")


class Constant:
    def __init__(self, element):
        self.name = check_name(element.get("name"), SNAKE, "constant")
        check_attributes(element, self.name)
        self.comment, self.type, self.value = comment(element), element.get("type"), element.get("value")
        if self.type not in ("string", "u32", "f32"):
            raise SchemaError(f"{self.name}: a constant is a string, u32 or f32 ({self.type})")
        self.cpp = {"string": "std::string_view", "u32": "uint32_t", "f32": "float"}[self.type]
        self.literal = f'"{self.value}"' if self.type == "string" else number_literal(self.type, self.value)
        self.python = f'b"{self.value}"' if self.type == "string" else self.value
        self.glsl = TYPES[self.type][1] if self.type != "string" else None


class Section:
    def __init__(self, element, records):
        self.name = check_name(element.get("name"), SNAKE, "section")
        check_attributes(element, self.name)
        self.kind = int(element.get("kind"))
        self.record = records.get(element.get("record"))
        if not self.record and element.get("type") != "u8":
            raise SchemaError(f"section {self.name}: neither a known record nor u8")
        self.cpp = self.record.name if self.record else "std::byte"
        self.size = self.record.size if self.record else 1
        self.same_count, self.always_raw = element.get("same_count"), element.get("always_raw") == "yes"
        self.min_count, self.max_count = element.get("min_count"), element.get("max_count")
        self.single = self.min_count == "1" and self.max_count == "1"
        self.checks = []


def number_literal(kind, text):
    """What C++ and GLSL read as that type: 0.01 -> 0.01f, 7 -> 7u; f64 is a double."""
    return {"u8": text + "u", "u32": text + "u", "u64": text + "ull"}.get(kind) or (
        f"{float(text)!r}" + ("f" if kind == "f32" else ""))


class Check:
    """One scalar of a record: `path` for messages, `holds` the C++ condition, `what` the C++ expression of the fault."""

    def __init__(self, path, holds, what):
        self.path, self.holds, self.what = path, holds, what


def field_checks(field, records, prefix, path_prefix=""):
    """Checks of one field, its array elements and components; `prefix` is the C++ expression of the record."""
    checks = []
    elements = [f"[{i}]" for i in range(field.count)] if field.count > 1 else [""]
    for element in elements:
        value, path = f"{prefix}.{field.name}{element}", f"{path_prefix}{field.name}{element}"
        if field.type == "string":
            for inner in records["StringRef"].fields:
                checks += field_checks(inner, records, value, f"{path}.")
        elif field.type in FLOATS:
            kind = FLOATS[field.type]
            cpp = {"f32": "float", "f64": "double"}[kind]
            low = f"lowest<{cpp}>" if field.min is None else number_literal(kind, field.min)
            high = f"highest<{cpp}>" if field.max is None else number_literal(kind, field.max)
            for component in "xyzw"[:field.components] if field.components > 1 else [""]:
                dot = "." + component if component else ""
                args = f"{value}{dot}, {low}, {high}"
                checks.append(Check(path + dot, f"within({args})", f"range_fault({args})"))
        else:
            checks += integer_checks(field, value, path, prefix)
    return checks


def integer_checks(field, value, path, prefix):
    checks = []
    if field.min is not None or field.max is not None:
        low = number_literal(field.type, field.min or "0")
        high = number_literal(field.type, field.max) if field.max else f"std::numeric_limits<{field.cpp_base}>::max()"
        args = f"{value}, {low}, {high}"
        checks.append(Check(path, f"within<{field.cpp_base}>({args})", f"range_fault<{field.cpp_base}>({args})"))
    if field.enum:
        checks.append(Check(path, f"is_valid({value})", f'enum_fault({value}, "{field.enum}")'))
    if field.index:
        holds = f"({value} < n.{field.index})"
        if field.optional:
            holds = f"({holds} | ({value} == none))"
        checks.append(Check(path, holds, f'index_fault({value}, n.{field.index}, "{field.index}")'))
    if field.run:
        args = f"{value}, {prefix}.{field.length}, n.{field.run}"
        checks.append(Check(path, f"run_fits({args})", f'run_fault({args}, "{field.length}", "{field.run}")'))
    return checks


class Schema:
    def __init__(self, path):
        root = ET.parse(path).getroot()
        check_attributes(root, "schema")
        self.name, self.namespace = root.get("name"), root.get("namespace")
        self.version, self.file = int(root.get("version")), Path(path).name
        self.constants = [Constant(e) for e in root.findall("constant")]
        self.enums = [Enum(e) for e in root.findall("enum")]
        self.by_name = {}
        for element in root.findall("record"):
            record = Record(element, self.by_name)
            if record.name in self.by_name:
                raise SchemaError(f"{record.name}: declared twice")
            self.by_name[record.name] = record
        self.records = list(self.by_name.values())
        self.gpu_records = [r for r in self.records if r.gpu]
        self.sections = [Section(e, self.by_name) for e in root.findall("section")]
        self.recipe = RecipeTable(root)
        self.check_references()
        for section in self.sections:
            if section.record:
                for field in section.record.fields:
                    section.checks += field_checks(field, self.by_name, "r")
        self.hash = int.from_bytes(hashlib.sha256(self.canonical().encode()).digest()[:8], "little")

    def check_references(self):
        sections, enums = {s.name for s in self.sections}, {e.name for e in self.enums}
        kinds = [s.kind for s in self.sections]
        if kinds != sorted(set(kinds)) or len(sections) != len(kinds):
            raise SchemaError("sections: kinds must ascend and names differ")
        for section in self.sections:
            if section.same_count and section.same_count not in sections:
                raise SchemaError(f"section {section.name}: same_count names no section ({section.same_count})")
        for record in self.records:
            fields = {f.name for f in record.fields}
            for field in record.fields:
                place = f"{record.name}.{field.name}"
                if field.enum and field.enum not in enums:
                    raise SchemaError(f"{place}: no such enum ({field.enum})")
                for target in (field.index, field.run):
                    if target and target not in sections:
                        raise SchemaError(f"{place}: no such section ({target})")
                if field.run and field.length not in fields:
                    raise SchemaError(f"{place}: no such length field ({field.length})")

    def constant(self, name):
        return next(c.value for c in self.constants if c.name == name)

    def canonical(self):
        """The input of the hash: everything that determines how bytes are read, no comments."""
        lines = [f"schema {self.name} {self.version}"]
        lines += [f"constant {c.name} {c.type} {c.value}" for c in self.constants]
        for enum in self.enums:
            lines += [f"enum {enum.name}"] + [f" {name} {value}" for name, value, _ in enum.values]
        for record in self.records:
            lines += [f"record {record.name} {record.size}"]
            lines += [f" {f.name} {f.type_text} {f.offset} {f.enum or ''}".rstrip() for f in record.fields]
        lines += [f"section {s.kind} {s.name} {s.cpp}" + " raw" * s.always_raw for s in self.sections]
        return "\n".join(lines) + "\n"


def environment():
    env = jinja2.Environment(loader=jinja2.FileSystemLoader(Path(__file__).parent / "templates"), trim_blocks=True,
                             lstrip_blocks=True, keep_trailing_newline=True, undefined=jinja2.StrictUndefined)
    env.filters["upper_name"] = upper
    env.filters["cell"] = lambda text: text.replace("|", r"\|")  # of a table in Markdown
    return env


def outputs(schema):
    """(file, template, record or stage) of everything the build needs."""
    name = schema.name
    files = [(f"{name}_schema.h", "schema.h.j2", None), (f"{name}_schema.glsl", "schema.glsl.j2", None),
             (f"{name}_echo_list.h", "echo_list.h.j2", None)]
    if schema.sections:
        files += [(f"{name}_schema.cpp", "schema.cpp.j2", None), (f"{name}_schema.py", "schema.py.j2", None)]
    if schema.recipe.stages:
        files.append(("recipe_schema.h", "recipe.h.j2", None))
        for stage in schema.recipe.stages:
            if stage.code == "glsl":
                files.append((f"stages/{stage.member}.glsl", "stage.glsl.j2", stage))
            if stage.has_state:
                files.append((f"stages/{stage.member}.h", "stage_state.h.j2", stage))
            if stage.code == "compute":
                files += [(f"stages/{stage.member}.h", "stage.h.j2", stage),
                          (f"stages/{stage.member}_shaders.h", "stage_shaders.h.j2", stage)]
    return files + [(f"echo/{r.name}.comp", "echo.comp.j2", r) for r in schema.gpu_records]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--schema", required=True, type=Path, metavar="FILE.xml")
    parser.add_argument("--out", type=Path, metavar="DIR")
    parser.add_argument("--list", action="store_true", help="name the files, write nothing")
    parser.add_argument("--page", type=Path, metavar="PAGE.md")
    parser.add_argument("--check-page", type=Path, metavar="PAGE.md")
    options = parser.parse_args()
    if not (options.out or options.page or options.check_page):
        parser.error("one of --out, --page, --check-page is needed")
    schema, env = Schema(options.schema), environment()
    if options.out:
        for name, template, subject in outputs(schema):
            target = options.out / name
            if options.list:
                print(target)
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            text = env.get_template(template).render(s=schema, record=subject, stage=subject)
            if not target.exists() or target.read_text(encoding="utf-8") != text:  # what includes it stays as it is
                target.write_text(text, encoding="utf-8")
    if options.page or options.check_page:
        page = env.get_template("FORMAT.md.j2" if schema.sections else "RECIPES.md.j2").render(s=schema)
        if options.page:
            options.page.write_text(page, encoding="utf-8")
        elif options.check_page.read_text(encoding="utf-8") != page:
            raise SchemaError(f"{options.check_page}: not what {schema.file} and the template say; "
                              f"run generate.py --schema {options.schema} --page {options.check_page}")


if __name__ == "__main__":
    try:
        main()
    except (SchemaError, OSError, ET.ParseError) as error:
        sys.exit(f"generate.py: error: {error}")
