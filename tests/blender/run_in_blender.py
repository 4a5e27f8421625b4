# SPDX-License-Identifier: Apache-2.0
"""Runs test files of in_blender/ inside Blender: one process for each, with user folders of its own.

  run_in_blender.py FILE.py [TEST …]
CHANDELIER_BLENDER: another program than the blender in PATH. CHANDELIER_ADDON: the add-on's module, where it is an extension.
Exit status: 0 passed, 77 where every test was skipped or there is no Blender, else failed."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
SKIPPED = 77


def blender():
    """The program; nothing where there is none."""
    return shutil.which(os.environ.get("CHANDELIER_BLENDER", "blender"))


def environment(folder):
    """Blender's user folders in `folder`, with the add-on's source among its scripts, or where CHANDELIER_ADDON says that it is
    one, among its extensions."""
    is_extension = os.environ.get("CHANDELIER_ADDON", "").startswith("bl_ext.")
    addons = folder / ("extensions/user_default" if is_extension else "scripts/addons")
    addons.mkdir(parents=True)
    (addons / "chandelier").symlink_to(SOURCE / "blender_addon" / "chandelier")
    variables = dict(os.environ, CHANDELIER_SOURCE=str(SOURCE), PYTHONDONTWRITEBYTECODE="1")
    for name in ("CONFIG", "SCRIPTS", "DATAFILES", "EXTENSIONS"):
        variables[f"BLENDER_USER_{name}"] = str(folder / name.lower())
    return variables


def main():
    if not blender():
        print("SKIPPED: no blender in PATH")
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        command = [blender(), "--background", "--factory-startup", "--python-exit-code", "3",
                   "--python", HERE / "in_blender" / "bootstrap.py", "--", *sys.argv[1:]]
        return subprocess.run(command, env=environment(pathlib.Path(folder))).returncode


if __name__ == "__main__":
    sys.exit(main())
