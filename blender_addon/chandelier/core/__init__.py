# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that does not need Blender: plain Python and numpy, so tests run without it."""
