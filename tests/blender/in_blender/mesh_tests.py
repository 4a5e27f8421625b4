# SPDX-License-Identifier: Apache-2.0
"""What meshes become in the exported file: which cast no shadow, and how shape keys come out."""

import bpy

from blender_case import part
from gltf_tests import GltfCase

HAS_SHADOW_MODE = "shadow_method" in bpy.types.Material.bl_rna.properties  # EEVEE's, until 4.1


class MeshCase(GltfCase):
    def cube(self, name, size=1.0, location=(0, 0, 0), collection=None):
        bpy.ops.mesh.primitive_cube_add(size=size, location=location)
        made = bpy.context.object
        made.name = name
        if collection:
            self.scene.collection.objects.unlink(made)
            collection.objects.link(made)
        return made

    def material(self, name, **values):
        made = bpy.data.materials.new(name)
        made.use_nodes = True
        for key, value in values.items():
            setattr(made, key, value)
        return made

    def keyed(self, **keys):
        """A cube with a key for each name, which moves its upper vertices up by so much."""
        cube = self.cube("Cube", size=2)
        cube.shape_key_add(name="Basis")
        for name, height in keys.items():
            key = cube.shape_key_add(name=name)
            for number, vertex in enumerate(cube.data.vertices):
                if vertex.co.z > 0:
                    key.data[number].co.z += height
        return cube

    def shadowless(self, kind="nodes"):
        """Names of the file's nodes or materials whose extras say so."""
        return sorted(thing["name"] for thing in self.gltf()[kind] if thing.get("extras") == {"chandelier": {"shadow": False}})


class NoShadow(MeshCase):
    def test_an_object_says_so_by_its_ray_visibility(self):
        self.cube("Bulb").visible_shadow = False
        self.cube("Table")
        self.export()
        self.assertEqual(self.shadowless(), ["Bulb"])

    def test_text_and_curves_too(self):
        bpy.ops.object.text_add()
        bpy.context.object.visible_shadow = False
        bpy.ops.curve.primitive_bezier_circle_add()
        ring = bpy.context.object
        ring.name, ring.visible_shadow, ring.data.bevel_depth = "Ring", False, 0.1
        self.export()
        self.assertEqual(self.shadowless(), ["Ring", "Text"])

    def test_a_material_says_so_by_its_shadow_mode(self):
        if not HAS_SHADOW_MODE:
            self.skipTest("materials have no shadow mode here")
        cube = self.cube("Lamp")
        cube.data.materials.append(self.material("Shade", shadow_method="NONE"))
        cube.data.materials.append(self.material("Foot", shadow_method="HASHED"))
        for face in cube.data.polygons:
            face.material_index = face.index % 2
        self.export()
        self.assertEqual((self.shadowless(), self.shadowless("materials")), ([], ["Shade"]))

    def test_custom_properties_stay(self):
        bulb = self.cube("Bulb")
        bulb.visible_shadow, bulb["artist"] = False, "me"
        bpy.ops.export_scene.gltf(filepath=str(self.path), export_extras=True)
        (node,) = [node for node in self.gltf()["nodes"] if node["name"] == "Bulb"]
        self.assertEqual(node["extras"], {"artist": "me", "chandelier": {"shadow": False}})

    def test_a_lamp_that_is_a_parent_keeps_its_childs_shadow(self):
        bulb = self.cube("Bulb")
        bulb.visible_shadow = False
        self.cube("Foot", location=(0, 0, -2)).parent = bulb
        self.export()
        self.assertEqual(self.shadowless(), ["Bulb"])

    def test_members_of_a_collection_keep_their_own(self):
        collection = bpy.data.collections.new("Lamp")
        self.cube("Bulb", collection=collection).visible_shadow = False
        self.cube("Foot", location=(0, 0, -2), collection=collection)
        for i in range(2):
            self.add_instance(collection, (5 * i, 0, 0))
        self.export()
        self.assertEqual(self.shadowless(), ["Bulb", "Bulb"])

    def test_what_instances_them_can_switch_it_off(self):
        collection = bpy.data.collections.new("Lamp")
        self.cube("Foot", collection=collection)
        self.add_instance(collection).visible_shadow = False
        self.add_instance(collection, (5, 0, 0))
        self.export()
        self.assertEqual(self.shadowless(), ["Foot"])
        self.assertEqual(len([node for node in self.gltf()["nodes"] if node["name"] == "Foot"]), 2)

    def test_a_child_of_what_instances_a_collection_keeps_its_own(self):
        """It is not instanced. 3.4 leaves it out."""
        collection = bpy.data.collections.new("Lamp")
        self.cube("Foot", collection=collection)
        instancer = self.add_instance(collection)
        instancer.visible_shadow = False
        child = self.cube("Child", location=(3, 0, 0))
        child.parent = instancer
        self.cube("Grandchild", location=(3, 0, 3)).parent = child
        self.export()
        self.assertEqual(self.shadowless(), ["Foot"])
        if bpy.app.version >= (4, 0):
            self.assertLessEqual({"Child", "Grandchild"}, {node["name"] for node in self.gltf()["nodes"]})

    def test_children_that_are_instanced_on_vertices_do_not(self):
        instancer, child = self.cube("Instancer"), self.cube("Child", size=0.1)
        child.parent, instancer.instance_type, instancer.visible_shadow = instancer, "VERTS", False
        instancer.show_instancer_for_render = False
        self.export()
        self.assertEqual(self.shadowless(), 8 * ["Child"])

    def test_of_nested_instances_the_outermost_counts(self):
        """As in Cycles."""
        inner, outer = bpy.data.collections.new("Inner"), bpy.data.collections.new("Outer")
        self.cube("Bulb", collection=inner)
        middle = self.add_instance(inner)
        self.scene.collection.objects.unlink(middle)
        outer.objects.link(middle)
        placed = self.add_instance(outer)
        for of_middle, of_placed, expected in ((False, True, []), (True, False, ["Bulb"]), (False, False, ["Bulb"])):
            middle.visible_shadow, placed.visible_shadow = of_middle, of_placed
            self.export()
            self.assertEqual(self.shadowless(), expected)

    def test_collections_that_are_nodes_are_in_nobodys_way(self):
        option = "export_hierarchy_full_collections"
        if option not in bpy.ops.export_scene.gltf.get_rna_type().properties:
            self.skipTest("the exporter makes no nodes of collections here")
        collection = bpy.data.collections.new("Lamp")
        self.scene.collection.children.link(collection)
        self.cube("Bulb", collection=collection).visible_shadow = False
        bpy.ops.export_scene.gltf(filepath=str(self.path), **{option: True})
        self.assertIn("Lamp", [node["name"] for node in self.gltf()["nodes"]])
        self.assertEqual(self.shadowless(), ["Bulb"])

    def test_a_linked_library_and_an_override(self):
        bulb, foot = self.cube("Bulb"), self.cube("Foot", location=(0, 0, -2))
        bulb.visible_shadow = False
        library = self.link_library(bulb, foot)
        self.add_instance(library)
        self.export()
        self.assertEqual(self.shadowless(), ["Bulb"])
        bpy.data.objects.remove(bpy.data.objects["Here"])
        linked = library.objects["Foot"]
        self.scene.collection.objects.link(linked)
        linked.override_create(remap_local_usages=True).visible_shadow = False
        self.export()
        self.assertEqual(self.shadowless(), ["Foot"])

    def test_the_check_names_what_came_out_otherwise(self):
        self.cube("Bulb").visible_shadow = False
        self.cube("Table").data.materials.append(self.material("Wood"))
        self.export()
        gltf = self.gltf()
        for thing in (*gltf["nodes"], *gltf["materials"]):
            if thing["name"] in ("Bulb", "Table", "Wood"):
                thing["extras"] = {} if thing["name"] == "Bulb" else {"chandelier": {"shadow": False}}
        meant = part("shadows").meant(bpy.context.evaluated_depsgraph_get())
        self.assertEqual(sorted(part("core.gltf_check").check_shadows(gltf, *meant)), [
            "Bulb: casts a shadow in the file, but should cast none", "Table: casts no shadow in the file, but should cast one",
            "Wood: casts no shadow in the file, but should cast one"])

    def test_the_validator_has_nothing_to_say(self):
        bulb = self.cube("Bulb")
        bulb.visible_shadow = False
        bulb.data.materials.append(self.material("Glass", **({"shadow_method": "NONE"} if HAS_SHADOW_MODE else {})))
        self.export()
        self.assert_valid()


class Glass(MeshCase):
    def test_linked_sockets_say_nothing_of_it(self):
        """A bulb around a lamp is glass by its material's values alone; where one of them is linked, it is a surprise."""
        material = self.material("Glass")
        self.cube("Bulb", size=0.2).data.materials.append(material)
        self.lamp()
        links, inputs = material.node_tree.links, material.node_tree.nodes["Principled BSDF"].inputs
        metallic, transmission = inputs["Metallic"], inputs["Transmission" if "Transmission" in inputs else "Transmission Weight"]
        transmission.default_value = 1
        value = material.node_tree.nodes.new("ShaderNodeValue").outputs[0]
        for linked in ([], [transmission], [metallic], [transmission, metallic]):
            made = [links.new(value, socket) for socket in linked]
            self.assertEqual(part("shadows").is_glass(material), not linked)
            self.assertEqual(bpy.ops.chandelier.find_surprises(), {"FINISHED"})
            found = [item.name for item in bpy.context.window_manager.chandelier.surprises if item.rule == "inside"]
            self.assertEqual(found, ["Lamp"] if linked else [])
            for link in made:
                links.remove(link)


class ShapeKeys(MeshCase):
    def assert_as_seen(self, cube, has_targets):
        """The file's vertices, morphed by its weights, reach as high as Blender's evaluated ones."""
        self.export()
        gltf = self.gltf()
        mesh = gltf["meshes"][next(node["mesh"] for node in gltf["nodes"] if node["name"] == cube.name)]
        (primitive,) = mesh["primitives"]
        self.assertEqual("targets" in primitive, has_targets)
        tops = [gltf["accessors"][number]["max"][1] for number in (
            primitive["attributes"]["POSITION"], *(target["POSITION"] for target in primitive.get("targets", ())))]
        written = tops[0] + sum(weight * top for weight, top in zip(mesh.get("weights", ()), tops[1:]))
        evaluated = cube.evaluated_get(bpy.context.evaluated_depsgraph_get())
        seen = max(vertex.co.z for vertex in evaluated.to_mesh().vertices)
        evaluated.to_mesh_clear()
        self.assertAlmostEqual(written, seen, places=5)
        self.assertNotIn("As seen", cube.modifiers)
        return mesh

    def test_values_are_the_meshs_weights(self):
        cube = self.keyed(Up=2, Further=4)
        blocks = cube.data.shape_keys.key_blocks
        blocks["Up"].value, blocks["Further"].value = 1, 0.25
        mesh = self.assert_as_seen(cube, True)
        self.assertEqual((mesh["weights"], mesh["extras"]["targetNames"]), ([1, 0.25], ["Up", "Further"]))

    def test_a_muted_key_does_not_count(self):
        cube = self.keyed(Up=2, Muted=5)
        for key in cube.data.shape_keys.key_blocks[1:]:
            key.value = 1
        cube.data.shape_keys.key_blocks["Muted"].mute = True
        self.assertEqual(self.assert_as_seen(cube, True)["weights"], [1])

    def test_a_value_between_keyframes(self):
        cube = self.keyed(Up=2)
        key = cube.data.shape_keys.key_blocks["Up"]
        for frame, value in ((1, 0.0), (11, 1.0)):
            key.value = value
            key.keyframe_insert("value", frame=frame)
        self.scene.frame_set(6)
        (weight,) = self.assert_as_seen(cube, True)["weights"]
        self.assertAlmostEqual(weight, 0.5, places=5)

    def test_a_key_that_a_vertex_group_limits(self):
        cube = self.keyed(Up=2)
        group = cube.vertex_groups.new(name="Half")
        group.add(list(range(8)), 0.5, "REPLACE")
        key = cube.data.shape_keys.key_blocks["Up"]
        key.value, key.vertex_group = 1, "Half"
        self.assert_as_seen(cube, False)

    def test_a_key_that_is_relative_to_another(self):
        cube = self.keyed(Up=2, Further=5)
        blocks = cube.data.shape_keys.key_blocks
        blocks["Further"].relative_key, blocks["Further"].value = blocks["Up"], 1
        self.assert_as_seen(cube, False)

    def test_a_pinned_key(self):
        cube = self.keyed(Up=2)
        cube.show_only_shape_key, cube.active_shape_key_index = True, 1
        self.assert_as_seen(cube, False)

    def test_absolute_keys(self):
        cube = self.keyed(Up=2)
        keys = cube.data.shape_keys
        keys.use_relative, keys.eval_time = False, 5
        self.assert_as_seen(cube, False)

    def test_modifiers_that_only_deform(self):
        cube = self.keyed(Up=2)
        cube.data.shape_keys.key_blocks["Up"].value = 1
        modifier = cube.modifiers.new("Higher", "DISPLACE")
        modifier.direction, modifier.strength = "Z", 1
        self.assert_as_seen(cube, False)

    def test_modifiers_that_make_the_mesh_anew(self):
        cube = self.keyed(Up=2)
        cube.data.shape_keys.key_blocks["Up"].value = 1
        cube.modifiers.new("Finer", "SUBSURF")
        self.assert_as_seen(cube, False)

    def test_an_armature_keeps_the_targets(self):
        bpy.ops.object.armature_add()
        armature = bpy.context.object
        cube = self.keyed(Up=2)
        cube.data.shape_keys.key_blocks["Up"].value = 1
        cube.parent = armature
        cube.vertex_groups.new(name="Bone").add(list(range(8)), 1, "REPLACE")
        cube.modifiers.new("Bones", "ARMATURE").object = armature
        self.assertEqual(self.assert_as_seen(cube, True)["weights"], [1])

    def test_a_linked_object_is_named(self):
        cube = self.keyed(Up=2)
        cube.show_only_shape_key, cube.active_shape_key_index = True, 1
        self.add_instance(self.link_library(cube))
        bpy.context.view_layer.update()
        (error,) = part("export").export(bpy.context, str(self.path)).errors
        self.assertIn("Cube [library.blend]: belongs to another file", error)


class Baked(MeshCase):
    def setUp(self):
        super().setUp()
        self.lamp(location=(0, 0, 8))

    def test_what_throws_no_shadow_throws_none_in_the_pack(self):
        self.cube("Bulb").visible_shadow = False
        shade = self.cube("Shade", location=(4, 0, 0))
        shade.data.materials.append(self.material("Paper", **({"shadow_method": "NONE"} if HAS_SHADOW_MODE else {})))
        self.export()
        report = self.report()
        self.assertEqual((report["shadowless_instances"], report["triangles"]["shadowless"]), (1, 24 if HAS_SHADOW_MODE else 12))

    def test_shape_keys_reach_as_high_as_in_blender(self):
        cube = self.keyed(Up=2)
        cube.data.shape_keys.key_blocks["Up"].value = 0.5
        for pinned, height in ((False, 2), (True, 3)):
            cube.show_only_shape_key, cube.active_shape_key_index = pinned, 1
            self.export()
            self.assertAlmostEqual(self.report()["bounds_max_ws"][1], height, places=3)


del GltfCase, MeshCase  # they have no tests of their own
