# SPDX-License-Identifier: Apache-2.0
# The part of frame.xml that says what a recipe is: stages and their answers, settings, presets.
import re

from schema_page import CAMEL, DASHED, SNAKE, SchemaError, check_attributes, check_name, comment

NUMBERS = {"f32": "float", "u32": "uint32_t", "u64": "uint64_t"}


def shown(number):
    """As a reader writes it: 0.5 -> 0.5, 30.0 -> 30."""
    return str(int(number)) if number == int(number) else repr(number)


def literal(kind, text):
    return {"f32": f"{float(text)!r}f", "u32": text + "u", "u64": text + "ull"}[kind]


def camel(name):
    """light-frustum -> LightFrustum."""
    return "".join(part.capitalize() for part in name.split("-"))


class Answer:
    """One answer of a stage, or one choice of a setting."""

    def __init__(self, element, place):
        check_attributes(element, place)
        self.name, self.meaning = element.get("name"), comment(element)
        place = f"{place}.{self.name}"
        if not re.fullmatch(DASHED, self.name or ""):
            raise SchemaError(f"{place}: the name does not match {DASHED}")
        self.identifier = check_name(element.get("identifier", self.name.replace("-", "_")), SNAKE, place)
        self.constant = self.name.replace("-", "_").upper()
        self.camel = camel(self.name)
        self.is_on_gpu = element.get("on") != "cpu"
        self.keeps_order = element.get("order") != "any"
        if not self.meaning:
            raise SchemaError(f"{place}: has no text that explains it")


class Choice:
    """The common part of a stage and of a setting with named values: a C++ enum with answers, one of them the default."""

    def __init__(self, element, name, enum):
        self.name, self.enum = name, check_name(enum, CAMEL, name)
        self.answers = [Answer(e, name) for e in element.findall("answer")]
        names = [a.name for a in self.answers]
        if len(set(names)) != len(names):
            raise SchemaError(f"{name}: two answers have one name")
        default = [a for a in self.answers if a.name == element.get("default")]
        if not default:
            raise SchemaError(f"{name}: the default is none of its answers ({element.get('default')})")
        self.default = f"{self.enum}::{default[0].identifier}"
        self.default_name = default[0].name

    def value(self, name, place):
        """The C++ value of the answer of that name."""
        found = [a for a in self.answers if a.name == name]
        if not found:
            raise SchemaError(f"{place}: {self.name} has no such answer ({name})")
        return f"{self.enum}::{found[0].identifier}"


class Function:
    """A GLSL function that every answer of a stage has, as "float visibility(ShadowMap map, Receiver receiver)"."""

    def __init__(self, text, place):
        match = re.fullmatch(r"\s*(\w+) (\w+)\(([^()]*)\)\s*", text)
        if not match:
            raise SchemaError(f"{place}: not a function: {text}")
        self.result, self.name, self.parameters = match.groups()
        self.arguments = ", ".join(parameter.split()[-1] for parameter in self.parameters.split(",") if parameter)


class Stage(Choice):
    def __init__(self, element):
        name = element.get("name")
        if not re.fullmatch(DASHED, name or ""):
            raise SchemaError(f"stage: the name does not match {DASHED} ({name})")
        check_attributes(element, name)
        super().__init__(element, name, camel(name))
        self.member = name.replace("-", "_")
        self.constant = self.member.upper()
        self.question, self.folder, self.code = element.get("question"), element.get("folder"), element.get("code")
        self.functions = [Function(text, self.name) for text in (element.get("functions") or "").split(";") if text]
        self.has_state, self.is_ordered = element.get("state") == "yes", element.get("ordered") == "yes"
        if (self.code is not None) != (self.folder is not None) or self.code not in (None, "compute", "glsl"):
            raise SchemaError(f"{self.name}: code is 'compute' or 'glsl' and stands with a folder ({self.code})")
        if (self.code == "glsl") != bool(self.functions):
            raise SchemaError(f"{self.name}: functions belong to code 'glsl', and only to that")
        if not self.question:
            raise SchemaError(f"{name}: has no question")


class Setting:
    """A member of Recipe beside the answers: a number, or one of several names."""

    def __init__(self, element):
        self.name = self.member = check_name(element.get("name"), SNAKE, "setting")
        check_attributes(element, self.name)
        self.meaning, self.option = comment(element), element.get("option", "")
        self.placeholder, self.unit = element.get("placeholder", "NAME"), element.get("unit", "")
        self.optional, self.scale = element.get("optional") == "yes", int(element.get("scale", "1"))
        self.choice = Choice(element, self.name, element.get("enum")) if element.get("enum") else None
        self.least = self.most = None
        if self.choice:
            self.cpp, self.default, self.default_text = self.choice.enum, self.choice.default, self.choice.default_name
        else:
            self.read_number(element)
        if self.optional:
            self.cpp = f"std::optional<{self.cpp}>"

    def read_number(self, element):
        kind = element.get("type")
        if kind not in NUMBERS:
            raise SchemaError(f"{self.name}: a setting is one of {', '.join(NUMBERS)}, or has an enum ({kind})")
        self.cpp, default = NUMBERS[kind], element.get("default")
        if (default is None) != self.optional:
            raise SchemaError(f"{self.name}: either it is optional or it has a default ({default})")
        self.default = None if self.optional else literal(kind, default)
        self.default_text = "" if self.optional else shown(float(default) / self.scale)
        least, most = element.get("least"), element.get("most")
        if (least is None) != (most is None):
            raise SchemaError(f"{self.name}: has one limit without the other")
        if least is None and (self.option or kind == "f32"):
            raise SchemaError(f"{self.name}: needs limits")
        if least is not None:
            self.least, self.most = literal(kind, least), literal(kind, most)
            # In whole units where an option is typed in larger ones.
            low, high = float(least), float(most)
            low, high = (low, high) if self.scale == 1 else (-(-low // self.scale), high // self.scale)
            self.typed_least, self.typed_most = low, high
            self.range_text = f"from {shown(low)} to {shown(high)}" + (f" {self.unit}" if self.unit else "")
            if default is not None and not float(least) <= float(default) <= float(most):
                raise SchemaError(f"{self.name}: the default is not within its limits ({default})")

    @property
    def title(self):
        """Its name in messages: the option's, if it has one."""
        return self.option or self.name


class Preset:
    def __init__(self, element, stages):
        self.name, self.meaning = element.get("name"), comment(element)
        if not re.fullmatch(DASHED, self.name or ""):
            raise SchemaError(f"preset: the name does not match {DASHED} ({self.name})")
        given = {k: v for k, v in element.attrib.items() if k != "name"}
        self.values = [(s, s.value(given.pop(s.name), self.name)) for s in stages if s.name in given]
        if given:
            raise SchemaError(f"{self.name}: there is no such stage ({', '.join(given)})")


class RecipeTable:
    def __init__(self, root):
        self.stages = [Stage(e) for e in root.findall("stage")]
        self.settings = [Setting(e) for e in root.findall("setting")]
        self.choices = [s.choice for s in self.settings if s.choice]
        self.presets = [Preset(e, self.stages) for e in root.findall("preset")]
        self.check_names()

    @property
    def enums(self):
        return self.stages + self.choices

    def check_names(self):
        for what, names in (("members of a recipe", [s.member for s in self.stages + self.settings]),
                            ("enums", [c.enum for c in self.enums]),
                            ("options", [s.name for s in self.stages] + [s.option for s in self.settings if s.option]),
                            ("presets", [p.name for p in self.presets])):
            twice = {n for n in names if names.count(n) > 1}
            if twice:
                raise SchemaError(f"{what}: two have one name ({', '.join(sorted(twice))})")
        if self.stages and not self.presets:
            raise SchemaError("presets: there is none")
