# SPDX-License-Identifier: Apache-2.0
"""Operators that place lights, and their undo."""

import contextlib
import io
import math

import bpy
import numpy as np
from mathutils import Vector

from blender_case import BlenderCase, part


class Place(BlenderCase):
    def lights(self):
        return sorted((thing for thing in self.scene.objects if thing.type == "LIGHT"), key=lambda thing: thing.name)

    def places(self):
        bpy.context.view_layer.update()
        return np.array([tuple(light.matrix_world.translation) for light in self.lights()])

    def curve(self, kind, points, cyclic=False, **where):
        data = bpy.data.curves.new("Path", "CURVE")
        data.dimensions = "3D"
        spline = data.splines.new(kind)
        if kind == "BEZIER":
            spline.bezier_points.add(len(points) - 1)
            for handle, point in zip(spline.bezier_points, points):
                handle.co = point
                handle.handle_left_type = handle.handle_right_type = "VECTOR"
        else:
            spline.points.add(len(points) - 1)
            for handle, point in zip(spline.points, points):
                handle.co = (*point, 1)
        spline.use_cyclic_u = cyclic
        data.bevel_depth = 0.1  # a tube: its middle is what counts
        made = self.add("Path", data, **where)
        self.select(made)
        return made

    def mesh(self, size=2.0, **where):
        bpy.ops.mesh.primitive_cube_add(size=size, **where)
        cube = bpy.context.object
        self.select(cube)
        return cube

    def test_fields_of_the_lights(self):
        self.select(self.add("Empty", location=(1, 2, 3)))
        bpy.ops.chandelier.place_at_selected(power=75, temperature=3000, range=6, radius=0.25)
        (light,) = self.lights()
        self.assertEqual((light.data.type, light.data.energy, light.data.use_custom_distance, light.data.cutoff_distance,
                          light.data.shadow_soft_size), ("POINT", 75, True, 6, 0.25))
        self.assertClose(light.data.color, part("core.photometry").colour_of_temperature(3000))
        self.assertClose(light.location, (1, 2, 3))
        self.assertEqual(bpy.context.selected_objects, [light])
        self.assertIs(bpy.context.view_layer.objects.active, light)

    def test_no_range_is_no_custom_distance(self):
        self.select(self.add("Empty"))
        bpy.ops.chandelier.place_at_selected(range=0)
        self.assertFalse(self.lights()[0].data.use_custom_distance)

    def test_along_curves_of_each_kind(self):
        for kind in ("POLY", "BEZIER"):
            self.curve(kind, ((0, 0, 0), (4, 0, 0), (4, 4, 0)), location=(10, 0, 0))
            bpy.ops.chandelier.place_along_curve(count=5)
            self.assertTrue(np.allclose(self.places(), [(10, 0, 0), (12, 0, 0), (14, 0, 0), (14, 2, 0), (14, 4, 0)]), kind)
            bpy.data.batch_remove(self.lights())
        self.curve("NURBS", ((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), (4, 0, 0), (5, 0, 0)))
        bpy.ops.chandelier.place_along_curve(count=4)
        self.assertTrue(np.allclose(self.places()[:, 1:], 0) and len(self.lights()) == 4)

    def test_along_a_closed_curve_by_spacing(self):
        self.curve("POLY", ((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)), cyclic=True)
        bpy.ops.chandelier.place_along_curve(by="SPACING", spacing=1)
        self.assertEqual(len(self.lights()), 8)
        self.assertEqual([len(bpy.data.curves), len([o for o in bpy.data.objects if o.type == "CURVE"])], [1, 1])  # no copy stays

    def test_along_a_filled_flat_curve(self):
        bpy.ops.curve.primitive_bezier_circle_add(radius=2)
        curve = bpy.context.object
        curve.data.dimensions, curve.data.fill_mode = "2D", "BOTH"
        self.select(curve)
        bpy.ops.chandelier.place_along_curve(count=12)
        places = self.places()
        self.assertEqual(len(places), 12)
        steps = np.linalg.norm(places - np.roll(places, 1, axis=0), axis=1)
        self.assertTrue(np.allclose(steps, 4 * math.sin(math.pi / 12), atol=0.01), steps)
        self.assertEqual((curve.data.dimensions, curve.data.fill_mode), ("2D", "BOTH"))

    def test_a_curve_that_is_moved_turned_and_scaled(self):
        curve = self.curve("POLY", ((0, 0, 0), (1, 0, 0)), location=(0, 5, 0))
        curve.scale, curve.rotation_euler = (4, 1, 1), (0, 0, math.pi / 2)
        bpy.context.view_layer.update()
        bpy.ops.chandelier.place_along_curve(by="SPACING", spacing=2)
        self.assertTrue(np.allclose(self.places(), [(0, 5, 0), (0, 7, 0), (0, 9, 0)], atol=1e-5))

    def test_around_objects(self):
        self.mesh(location=(3, 0, 1))
        bpy.ops.chandelier.place_around(count=6, distance=0.5, rings=2, step=1.5, height=0.25)
        places = self.places()
        self.assertEqual(len(places), 12)
        self.assertTrue(np.allclose(np.linalg.norm(places[:, :2] - (3, 0), axis=1), math.sqrt(2) + 0.5))
        self.assertEqual(sorted(set(places[:, 2].round(5).tolist())), [1.25, 2.75])

    def test_spots_around_an_object_shine_at_it(self):
        self.mesh()
        bpy.ops.chandelier.place_around(count=4, kind="SPOT")
        for light in self.lights():
            way = light.rotation_euler.to_quaternion() @ Vector((0, 0, -1))
            self.assertAlmostEqual(way.dot(-light.location.normalized()), 1, places=5)

    def test_spots_can_shine_down(self):
        self.curve("POLY", ((0, 0, 3), (4, 0, 3)))
        bpy.ops.chandelier.place_along_curve(count=3, kind="SPOT", aim="DOWN")
        bpy.context.view_layer.update()
        for light in self.lights():
            self.assertClose(light.matrix_world.to_quaternion() @ Vector((0, 0, -1)), (0, 0, -1))

    def test_spots_shine_out_of_faces(self):
        self.mesh()
        bpy.ops.chandelier.place_on_mesh(kind="SPOT", count=0, spacing=0)
        for light in self.lights():
            way = light.rotation_euler.to_quaternion() @ Vector((0, 0, -1))
            self.assertAlmostEqual(way.dot(light.location.normalized()), 1, places=5)

    def test_on_faces_and_vertices(self):
        cube = self.mesh(location=(0, 0, 5))
        bpy.ops.chandelier.place_on_mesh(count=0, spacing=0, offset=0.5)
        self.assertTrue(np.allclose(np.linalg.norm(self.places() - (0, 0, 5), axis=1), 1.5))
        self.assertEqual(len(self.lights()), 6)
        bpy.data.batch_remove(self.lights())
        self.select(cube)
        bpy.ops.chandelier.place_on_mesh(on="VERTICES", count=0, spacing=0, offset=0)
        self.assertEqual(len(self.lights()), 8)
        bpy.data.batch_remove(self.lights())
        self.select(cube)
        bpy.ops.chandelier.place_on_mesh(on="VERTICES", count=0, spacing=2.5, offset=0)
        places = self.places()
        self.assertTrue(1 < len(places) < 8)
        self.assertGreaterEqual(min(np.linalg.norm(a - b) for i, a in enumerate(places) for b in places[:i]), 2.5)

    def test_modifiers_count(self):
        cube = self.mesh()
        cube.modifiers.new("Finer", "SUBSURF").subdivision_type = "SIMPLE"
        bpy.ops.chandelier.place_on_mesh(count=0, spacing=0)
        self.assertEqual(len(self.lights()), 24)

    def test_scattered_in_a_mesh(self):
        bpy.ops.mesh.primitive_uv_sphere_add(radius=2, location=(1, 1, 1))
        self.select(bpy.context.object)
        bpy.ops.chandelier.scatter(volume="MESH", count=40, spacing=0.5, seed=3)
        places = self.places()
        self.assertEqual(len(places), 40)
        self.assertLess(np.linalg.norm(places - (1, 1, 1), axis=1).max(), 2)
        self.assertGreaterEqual(min(np.linalg.norm(a - b) for i, a in enumerate(places) for b in places[:i]), 0.5 - 1e-6)

    def test_scattered_in_a_box(self):
        self.mesh(size=4)
        bpy.ops.chandelier.scatter(count=30, spacing=0.2)
        self.assertEqual(len(self.lights()), 30)
        self.assertLess(abs(self.places()).max(), 2)

    def test_scattered_without_a_count(self):
        cube = self.mesh(size=2)
        bpy.ops.chandelier.scatter(count=0, spacing=0.7)
        self.assertTrue(10 < len(self.lights()) < 60, len(self.lights()))
        self.select(cube)
        self.assertEqual(bpy.ops.chandelier.scatter(count=0, spacing=0), {"CANCELLED"})

    def test_empties_are_as_large_as_they_are_shown(self):
        empty = self.add("Empty", location=(5, 0, 0))
        empty.empty_display_size = 2
        self.select(empty)
        bpy.ops.chandelier.scatter(count=20, spacing=0)
        places = self.places() - (5, 0, 0)
        self.assertTrue(1 < abs(places).max() <= 2)
        bpy.data.batch_remove(self.lights())
        self.select(empty)
        bpy.ops.chandelier.place_at_selected(at="MIDDLE")
        self.assertClose(self.places()[0], (5, 0, 0))

    def test_the_same_seed_gives_the_same_lights(self):
        cube = self.mesh(size=4)
        def scattered(seed):
            self.select(cube)
            bpy.ops.chandelier.scatter(count=12, seed=seed, jitter=0.1)
            places = self.places()
            bpy.data.batch_remove(self.lights())
            return places
        first = scattered(1)
        self.assertTrue((first == scattered(1)).all())
        self.assertFalse((first == scattered(2)).any())

    def test_shared_data(self):
        self.mesh()
        bpy.ops.chandelier.place_around(count=5, share=True)
        self.assertEqual(len({light.data for light in self.lights()}), 1)
        self.assertEqual(len(bpy.data.lights), 1)

    def test_undo_is_one_step_and_redo_brings_them_back(self):
        self.mesh()
        bpy.ops.ed.undo_push(message="before")
        bpy.ops.chandelier.place_around(count=7)
        bpy.ops.ed.undo_push(message="Around Objects")  # what Blender does after an operator that a user started
        before = self.places()
        bpy.ops.ed.undo()
        self.scene = bpy.context.scene
        self.assertEqual((len(self.lights()), len(bpy.data.lights)), (0, 0))
        bpy.ops.ed.redo()
        self.scene = bpy.context.scene
        self.assertTrue((self.places() == before).all())

    def test_blender_itself_undoes_them(self):
        self.mesh()
        bpy.ops.ed.undo_push(message="before")
        bpy.ops.chandelier.place_around("EXEC_DEFAULT", True, count=7)  # True: with an undo step, as from a button
        bpy.ops.ed.undo()
        self.scene = bpy.context.scene
        self.assertEqual(len(self.lights()), 0)

    def test_nothing_selected_is_no_place(self):
        self.select()
        for name, wanted in (("place_along_curve", "a curve"), ("place_around", "an object"), ("place_on_mesh", "a mesh"),
                             ("scatter", "an object"), ("place_at_selected", "an object")):
            with contextlib.redirect_stdout(io.StringIO()) as said:
                self.assertEqual(getattr(bpy.ops.chandelier, name)(), {"CANCELLED"}, name)
            self.assertIn(f"No light was placed: select {wanted}", said.getvalue())

    def test_lights_are_no_place_for_lights(self):
        self.select(self.add_light(), self.add("Empty"))
        bpy.ops.chandelier.place_around(count=4)
        self.assertEqual(len(self.lights()), 5)
        self.assertEqual(bpy.ops.chandelier.place_around(count=4), {"CANCELLED"})  # what was placed is selected now
        self.assertEqual(len(self.lights()), 5)

    def test_an_empty_mesh_places_nothing(self):
        self.select(self.add("Nothing", bpy.data.meshes.new("Nothing")))
        self.assertEqual(bpy.ops.chandelier.place_on_mesh(), {"CANCELLED"})
