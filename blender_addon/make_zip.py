#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs the add-on into one zip that Blender 3.4 installs as an add-on and 4.2 and later as an extension.

The zip holds the folder itself: 3.4 needs it, and the later ones take it. Libraries and programs that are named go into its
bin/ folder, where the add-on looks first; if none is named, the preview's library, where it has been built. With them go their
licences, and where they are Linux's the manifest says so. Same files, same bytes.
"""

import argparse
import pathlib
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
ADDON = HERE / "chandelier"
BUILD = HERE.parent / "build"
SUFFIXES = {".py", ".toml"}
LICENCES = (HERE.parent / "LICENSE", HERE.parent / "NOTICE", HERE / "LICENSE-GLM")  # of what is bundled
LINUX_X64 = b"\x7fELF\x02\x01"  # how its programs and libraries begin
OLDEST = (1980, 1, 1, 0, 0, 0)  # what a zip can date; the same in each


def files_of(addon, bundled):
    """Name in the zip -> path."""
    files = {f"{addon.name}/{path.relative_to(addon).as_posix()}": path
             for path in addon.rglob("*") if path.suffix in SUFFIXES}
    files[f"{addon.name}/LICENSE"] = HERE / "LICENSE"
    files.update({f"{addon.name}/bin/{path.name}": path for path in (*bundled, *(LICENCES if bundled else ()))})
    return files


def bytes_of(path, bundled):
    """As the zip has them: with programs of one platform it is an extension for that one."""
    data = path.read_bytes()
    if path.name == "blender_manifest.toml" and any(thing.read_bytes().startswith(LINUX_X64) for thing in bundled):
        return data.replace(b"\nlicense =", b"\nplatforms = [\"linux-x64\"]\nlicense =")
    return data


def write(target, bundled=()):
    target.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, path in sorted(files_of(ADDON, bundled).items()):
            entry = zipfile.ZipInfo(name, OLDEST)
            entry.compress_type = zipfile.ZIP_DEFLATED
            executable = path in bundled
            entry.external_attr = (0o755 if executable else 0o644) << 16
            archive.writestr(entry, bytes_of(path, bundled))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=pathlib.Path, default=BUILD / "blender" / "chandelier.zip")
    parser.add_argument("bundled", nargs="*", type=pathlib.Path, help="libraries and programs to carry along")
    arguments = parser.parse_args()
    bundled = arguments.bundled or list((BUILD / "lib").glob("libchandelier_preview.*"))
    missing = [path for path in bundled if not path.is_file()]
    if missing:
        parser.error(f"no such file: {missing[0]}")
    write(arguments.output, bundled)
    print(f"{arguments.output} with {', '.join(path.name for path in bundled) or 'neither library nor program'}")


if __name__ == "__main__":
    main()
