# SPDX-License-Identifier: GPL-3.0-or-later
"""Exports shape keys in their visible shape.

The exporter writes the basis, the other keys as morph targets and their values as weights, and so loses what a vertex group limits,
what is relative to another key, pinned or absolute, and modifiers that only deform. A mesh that a modifier has made anew it writes as
that left it, without targets. So what would come out otherwise than it is seen gets a modifier that changes nothing for the export."""

import contextlib

ALL_FACES = 2**31 - 1  # no face has so many corners that it would be cut


def has_plain_keys(thing):
    """Whether the basis, and each key's difference from it times its value, add up to what is seen."""
    keys = thing.data.shape_keys
    moving = [key for key in keys.key_blocks if key != keys.reference_key and not key.mute]
    return (keys.use_relative and not thing.show_only_shape_key
            and all(key.relative_key == keys.reference_key and key.vertex_group not in thing.vertex_groups for key in moving)
            and all(modifier.type == "ARMATURE" for modifier in thing.modifiers))  # which becomes a skin


def is_made_anew(thing, depsgraph):
    """Whether its modifiers make a mesh without keys."""
    evaluated = thing.evaluated_get(depsgraph)
    made = evaluated.to_mesh(preserve_all_data_layers=True, depsgraph=depsgraph).shape_keys is None
    evaluated.to_mesh_clear()
    return made


@contextlib.contextmanager
def exported_as_seen(depsgraph):
    """A context. Yields the names of objects of other files, which cannot be changed."""
    keyed = {instance.object.original: True for instance in depsgraph.object_instances
             if instance.object.type == "MESH" and instance.object.original.data.shape_keys}
    odd = [thing for thing in keyed if not has_plain_keys(thing) and not is_made_anew(thing, depsgraph)]
    own = [thing for thing in odd if thing.library is None]
    added = []
    try:
        for thing in own:
            added.append((thing, thing.modifiers.new("As seen", "TRIANGULATE")))
            added[-1][1].min_vertices = ALL_FACES
        yield [thing.name_full for thing in odd if thing not in own]
    finally:
        for thing, modifier in added:
            thing.modifiers.remove(modifier)
