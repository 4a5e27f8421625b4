# SPDX-License-Identifier: Apache-2.0
"""Runs test files of in_blender/ inside Blender: one process for each, with user folders of its own.

  run_in_blender.py FILE.py [TEST …]
CHANDELIER_BLENDER_ROOT: a folder with another Debian, whose Blender it shall be, with the add-on as an extension.
Exit status: 0 passed, 77 where every test was skipped or there is no Blender, else failed."""

import os
import pathlib
import shutil
import stat
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
ROOT = os.environ.get("CHANDELIER_BLENDER_ROOT")
SKIPPED = 77


def environment(folder):
    """Blender's user folders in `folder`, with the add-on's source among its add-ons, or its extensions."""
    addons = folder / ("extensions/user_default" if ROOT else "scripts/addons")
    addons.mkdir(parents=True)
    (addons / "chandelier").symlink_to(SOURCE / "blender_addon" / "chandelier")
    variables = dict(os.environ, CHANDELIER_SOURCE=str(SOURCE), PYTHONDONTWRITEBYTECODE="1")
    for name in ("CONFIG", "SCRIPTS", "DATAFILES", "EXTENSIONS"):
        variables[f"BLENDER_USER_{name}"] = str(folder / name.lower())
    return {**variables, **of_host(folder / "bin")} if ROOT else variables


def of_host(folder):
    """This system's programs, for a Blender that is in a folder with another."""
    folder.mkdir()
    built = pathlib.Path(os.environ.get("CHANDELIER_BIN", SOURCE / "build" / "bin"))
    programs = [*built.glob("chandelier-*"), *(shutil.which(name) for name in ("import", "node", "npm") if shutil.which(name))]
    for program in programs:
        path = folder / pathlib.Path(program).name
        path.write_text(f'#!/bin/sh\nexec chroot /host /usr/bin/env -C "$PWD" "{program}" "$@"\n')
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return {"CHANDELIER_BIN": str(folder), "CHANDELIER_ADDON": "bl_ext.user_default.chandelier",
            "PATH": f"{folder}:/usr/sbin:/usr/bin:/sbin:/bin"}


def blender():
    """The command that starts it; nothing where there is none."""
    if ROOT:
        return ["unshare", "--mount", str(HERE / "in_root.sh"), ROOT, str(SOURCE)]
    found = shutil.which("blender")
    return [found] if found else []


def main():
    if not blender():
        print("SKIPPED: no blender in PATH")
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        command = [*blender(), "--background", "--factory-startup", "--python-exit-code", "3",
                   "--python", HERE / "in_blender" / "bootstrap.py", "--", *sys.argv[1:]]
        return subprocess.run(command, env=environment(pathlib.Path(folder))).returncode


if __name__ == "__main__":
    sys.exit(main())
