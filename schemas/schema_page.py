# SPDX-License-Identifier: Apache-2.0
# What every part of a schema page is read with: names, attributes, texts.
import re

ATTRIBUTES = {
    "schema": {"name", "namespace", "version"},
    "constant": {"name", "type", "value"},
    "enum": {"name"},
    "value": {"name", "value"},
    "record": {"name", "gpu"},
    "field": {"name", "type", "count", "unit", "min", "max", "enum", "index", "optional", "run", "length"},
    "section": {"kind", "name", "record", "type", "same_count", "min_count", "max_count", "always_raw"},
    "stage": {"name", "question", "default", "folder", "code", "functions", "state", "ordered"},
    "answer": {"name", "identifier", "on", "order"},
    "setting": {"name", "option", "placeholder", "type", "enum", "unit", "scale", "default", "least", "most", "optional"},
}
# Words that C++, GLSL or Python keep for themselves and that a schema might want.
RESERVED = set(
    "active and asm auto bool break case char class common const default delete do double else enum explicit extern "
    "false filter fixed flat float for from goto half if import in inline input int is lambda length long mutable namespace "
    "new not operator or out output partition pass private public register resource return sample sampler short "
    "signed sizeof static struct switch template this true typedef union unsigned using virtual void volatile while "
    "with yield".split())


class SchemaError(Exception):
    pass


def comment(element):
    """The element's own text on one line."""
    return " ".join((element.text or "").split())


def check_name(name, pattern, place):
    if not re.fullmatch(pattern, name):
        raise SchemaError(f"{place}: the name does not match {pattern} ({name})")
    if name in RESERVED:
        raise SchemaError(f"{place}: the name is a reserved word ({name})")
    return name


SNAKE, CAMEL, DASHED = r"[a-z][a-z0-9_]*", r"[A-Z][A-Za-z0-9]*", r"[a-z][a-z0-9-]*"


def check_attributes(element, place):
    unknown = set(element.attrib) - ATTRIBUTES[element.tag]
    if unknown:
        raise SchemaError(f"{place}: unknown attribute ({', '.join(sorted(unknown))})")


def upper(name):
    """LightType -> LIGHT_TYPE, none -> NONE."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).upper()
