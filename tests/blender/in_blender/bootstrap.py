# SPDX-License-Identifier: Apache-2.0
"""Inside Blender: enables the add-on and runs the tests of one file."""

import importlib
import pathlib
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
SKIPPED = 77


def main(file, *names):
    sys.dont_write_bytecode = True
    sys.path.insert(0, str(HERE))
    importlib.import_module("blender_case").enable_addon()
    module = importlib.import_module(pathlib.Path(file).stem)
    loader = unittest.defaultTestLoader
    suite = loader.loadTestsFromNames(names, module) if names else loader.loadTestsFromModule(module)
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    if not result.testsRun or not result.wasSuccessful():
        return 1
    return SKIPPED if len(result.skipped) == result.testsRun else 0


sys.exit(main(*sys.argv[sys.argv.index("--") + 1:]))
