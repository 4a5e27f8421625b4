# SPDX-License-Identifier: Apache-2.0
"""The rules of extensions.blender.org that `blender --command extension validate` knows, for where there is no such Blender."""

import ast
import pathlib
import re
import tomllib

ADDON = pathlib.Path(__file__).resolve().parents[2] / "blender_addon" / "chandelier"
MANIFEST = tomllib.loads((ADDON / "blender_manifest.toml").read_text())


def bl_info():
    tree = ast.parse((ADDON / "__init__.py").read_text())
    (value,) = [node.value for node in tree.body if isinstance(node, ast.Assign) and node.targets[0].id == "bl_info"]
    return ast.literal_eval(value)


def test_both_say_the_same():
    info = bl_info()
    assert MANIFEST["version"] == ".".join(map(str, info["version"]))
    assert MANIFEST["name"] == info["name"] and MANIFEST["maintainer"] == info["author"]
    assert info["blender"] == (3, 4, 0) and MANIFEST["blender_version_min"] == "4.2.0"


def test_texts_are_short_and_end_without_punctuation():
    for text in (MANIFEST["tagline"], *MANIFEST["permissions"].values()):
        assert len(text) <= 64 and re.search(r"[A-Za-z0-9)]$", text), text


def test_licence_and_kind():
    assert MANIFEST["schema_version"] == "1.0.0" and MANIFEST["type"] == "add-on" and MANIFEST["id"] == ADDON.name
    assert MANIFEST["license"] == ["SPDX:GPL-3.0-or-later"]
    assert "SPDX-License-Identifier: GPL-3.0-or-later" in (ADDON / "__init__.py").read_text()
    for path in ADDON.rglob("*.py"):
        assert path.read_text().startswith("# SPDX-License-Identifier: GPL-3.0-or-later\n"), path


def test_modules_do_not_name_the_package():
    """An extension's is bl_ext.….chandelier, so that imports are relative."""
    for path in ADDON.rglob("*.py"):
        assert not re.search(r"^\s*(from|import) chandelier\b", path.read_text(), re.MULTILINE), path
