# SPDX-License-Identifier: GPL-3.0-or-later
"""All that needs no Blender: plain Python and numpy, so that it is tested without it."""
