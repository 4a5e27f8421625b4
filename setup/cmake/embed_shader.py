#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Write a C++ header with a shader's SPIR-V and what has to be given to it: a chandelier::gpu::Shader.

  embed_shader.py NAME.spv NAME HEADER.h

It reads SPIR-V itself: Debian 12's `spirv-cross --reflect` tells neither the size of push constants nor, where glslang writes
LocalSizeId, that of a work group.
"""
import struct
import sys
from pathlib import Path

# SPIR-V specification, section 3: numbers of the instructions, decorations and storage classes that are looked at.
NAME, ENTRY_POINT, EXECUTION_MODE, EXECUTION_MODE_ID = 5, 15, 16, 331
TYPE_INT, TYPE_FLOAT, TYPE_VECTOR, TYPE_IMAGE, TYPE_SAMPLER, TYPE_SAMPLED_IMAGE = 21, 22, 23, 25, 26, 27
TYPE_ARRAY, TYPE_STRUCT, TYPE_POINTER, CONSTANT, SPEC_CONSTANT, VARIABLE = 28, 30, 32, 43, 50, 59
SPEC_TRUE, SPEC_FALSE = 48, 49
VERTEX = 0  # execution model
DECORATE, MEMBER_DECORATE = 71, 72
# Instructions that read or write through a variable, and where their operands have it; of a call, each argument may be one.
USES = {60: slice(2, 3), 61: slice(2, 3), 62: slice(0, 1), 65: slice(2, 3), 66: slice(2, 3), 68: slice(2, 3),
        83: slice(2, 3), 57: slice(3, None)}
SPEC_ID, ARRAY_STRIDE, LOCATION, BINDING, DESCRIPTOR_SET, OFFSET = 1, 6, 30, 33, 34, 35
UNIFORM_CONSTANT, INPUT, UNIFORM, PUSH_CONSTANT, STORAGE_BUFFER = 0, 1, 2, 9, 12
LOCAL_SIZE, LOCAL_SIZE_ID = 17, 38
READ_AND_WRITTEN = 2  # operand `Sampled` of an image type without a sampler


class ShaderError(Exception):
    pass


def text_of(words):
    return struct.pack(f"<{len(words)}I", *words).split(b"\0")[0].decode()


class Module:
    def __init__(self, words):
        if words[:1] != (0x07230203,):
            raise ShaderError("not SPIR-V")
        self.names, self.types, self.constants, self.variables = {}, {}, {}, []
        self.decorations, self.offsets, self.local_size, self.used = {}, {}, (0, 0, 0), set()
        self.is_vertex = False
        at = 5
        while at < len(words):
            count, op = words[at] >> 16, words[at] & 0xFFFF
            self.read(op, words[at + 1:at + count])
            at += count

    def read(self, op, args):
        if op == NAME:
            self.names[args[0]] = text_of(args[1:])
        elif op in (TYPE_INT, TYPE_FLOAT, TYPE_VECTOR, TYPE_IMAGE, TYPE_SAMPLER, TYPE_SAMPLED_IMAGE, TYPE_ARRAY,
                    TYPE_STRUCT, TYPE_POINTER):
            self.types[args[0]] = (op, args[1:])
        elif op in (CONSTANT, SPEC_CONSTANT):
            self.constants[args[1]] = args[2]
        elif op in (SPEC_TRUE, SPEC_FALSE):
            self.constants[args[1]] = op == SPEC_TRUE
        elif op == VARIABLE:
            self.variables.append((args[0], args[1], args[2]))
        elif op == DECORATE:
            self.decorations[args[0], args[1]] = args[2] if len(args) > 2 else 1
        elif op == MEMBER_DECORATE and args[2] == OFFSET:
            self.offsets[args[0], args[1]] = args[3]
        elif op == ENTRY_POINT:
            self.is_vertex = args[0] == VERTEX
        elif op in USES:
            self.used.update(args[USES[op]])
        elif op == EXECUTION_MODE and args[1] == LOCAL_SIZE:
            self.local_size = args[2:5]
        elif op == EXECUTION_MODE_ID and args[1] == LOCAL_SIZE_ID:
            self.local_size = args[2:5]
            self.local_size_is_id = True

    def work_group(self):
        if getattr(self, "local_size_is_id", False):
            return tuple(self.constants[i] for i in self.local_size)
        return self.local_size

    def size_of(self, kind):
        """Bytes of a type in a block."""
        op, args = self.types[kind]
        if op in (TYPE_INT, TYPE_FLOAT):
            return args[0] // 8
        if op == TYPE_VECTOR:
            return args[1] * self.size_of(args[0])
        if op == TYPE_ARRAY:
            return self.constants[args[1]] * self.decorations[kind, ARRAY_STRIDE]
        if op == TYPE_STRUCT:
            return max(self.offsets[kind, i] + self.size_of(member) for i, member in enumerate(args))
        raise ShaderError(f"push constants hold a type that is not known here (instruction {op})")

    def pointed_to(self, pointer):
        return self.types[pointer][1][1]

    def push_bytes(self):
        return max((self.size_of(self.pointed_to(pointer)) for pointer, _, storage in self.variables
                    if storage == PUSH_CONSTANT), default=0)

    def descriptor_type(self, kind, storage):
        op, args = self.types[kind]
        if storage == STORAGE_BUFFER:
            return "STORAGE_BUFFER"
        if storage == UNIFORM:
            return "UNIFORM_BUFFER"
        if op == TYPE_SAMPLED_IMAGE:
            return "COMBINED_IMAGE_SAMPLER"
        if op == TYPE_IMAGE:
            return "STORAGE_IMAGE" if args[5] == READ_AND_WRITTEN else "SAMPLED_IMAGE"
        if op == TYPE_SAMPLER:
            return "SAMPLER"
        raise ShaderError(f"a binding has a type that is not known here (instruction {op})")

    def bindings(self):
        """(set, binding, descriptor type, name, whether the code uses it), in order. A block without an instance has its own name."""
        found = []
        for pointer, variable, storage in self.variables:
            if storage in (UNIFORM_CONSTANT, UNIFORM, STORAGE_BUFFER):
                kind = self.pointed_to(pointer)
                found.append((self.decorations[variable, DESCRIPTOR_SET], self.decorations[variable, BINDING],
                              self.descriptor_type(kind, storage), self.names.get(variable) or self.names[kind],
                              "true" if variable in self.used else "false"))
        return sorted(found)


    def numbered(self, found, decoration):
        """(number, name) of ids with that decoration, in order."""
        return sorted((self.decorations[i, decoration], self.names[i]) for i in found if (i, decoration) in self.decorations)

    def spec_constants(self):
        return self.numbered(self.constants, SPEC_ID)

    def vertex_inputs(self):
        inputs = [variable for _, variable, storage in self.variables if storage == INPUT]
        return self.numbered(inputs, LOCATION) if self.is_vertex else []


def table(kind, name, rows):
    """A constant array, and what stands for it where there are no rows."""
    lines = "".join(f"    {{{', '.join(map(str, row))}}},\n" for row in rows)
    return (f"inline constexpr chandelier::gpu::{kind} {name}[]{{\n{lines}}};\n", name) if rows else ("", "{}")


def header(name, words):
    module = Module(words)
    bindings, bindings_name = table("Binding", f"{name}_bindings", [
        (s, b, f"VK_DESCRIPTOR_TYPE_{kind}", f'"{title}"', used) for s, b, kind, title, used in module.bindings()])
    constants, constants_name = table("Named", f"{name}_constants", [(n, f'"{t}"') for n, t in module.spec_constants()])
    inputs, inputs_name = table("Named", f"{name}_inputs", [(n, f'"{t}"') for n, t in module.vertex_inputs()])
    lines = (", ".join(f"0x{word:08x}" for word in words[i:i + 8]) for i in range(0, len(words), 8))
    return "\n".join((
        "// Generated by setup/cmake/embed_shader.py; changes here are lost.", "#pragma once", '#include "gpu/shader.h"', "",
        f"inline constexpr uint32_t {name}_words[]{{", ",\n".join(lines) + "};",
        f'{bindings}{constants}{inputs}inline constexpr chandelier::gpu::Shader {name}{{"{name}", {name}_words, {bindings_name}, '
        f"{module.push_bytes()}, {{{', '.join(map(str, module.work_group()))}}}, {constants_name}, {inputs_name}}};", ""))


def main():
    spirv, name, target = sys.argv[1:]
    data = Path(spirv).read_bytes()
    Path(target).write_text(header(name, struct.unpack(f"<{len(data) // 4}I", data)), encoding="utf-8")


if __name__ == "__main__":
    try:
        main()
    except (ShaderError, OSError, KeyError) as error:
        sys.exit(f"embed_shader.py: error: {sys.argv[1]}: {error}")
