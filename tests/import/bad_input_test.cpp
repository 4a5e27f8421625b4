// SPDX-License-Identifier: Apache-2.0
// Bad input: each is refused with a line that names the place, the fault and the value.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "gltf_builder.h"
#include "import/import.h"

namespace chandelier::baker::test {
namespace {

struct Case {
  const char* name;
  std::function<void(GltfBuilder&)> spoil;  // a good triangle
  const char* expected;                     // after "FILE: "
};

Json& primitive(GltfBuilder& gltf) {
  return gltf.json["meshes"][0]["primitives"][0];
}

// The triangle's accessors: 0 POSITION, 1 indices.
const Case cases[] = {
    {"no asset", [](GltfBuilder& g) { g.json.erase("asset"); }, "glTF: has no asset"},
    {"old version", [](GltfBuilder& g) { g.json["asset"]["version"] = "1.0"; },
     "glTF, asset, version: is not 2.x (\"1.0\")"},
    {"required extension", [](GltfBuilder& g) { g.json["extensionsRequired"] = {"KHR_animation_pointer"}; },
     "extensionsRequired: unknown extension (KHR_animation_pointer)"},
    {"section of another type", [](GltfBuilder& g) { g.json["nodes"] = "none"; }, "nodes: is not an array (\"none\")"},
    {"entry of another type", [](GltfBuilder& g) { g.json["nodes"][0] = 7; }, "node 0: is not an object (7)"},
    {"scene out of range", [](GltfBuilder& g) { g.json["scene"] = 3; },
     "glTF, scene: points past the end, there are 0 (3)"},
    {"negative index", [](GltfBuilder& g) { g.json["nodes"][0]["mesh"] = -1; },
     "node 0 'triangle', mesh: is not an index (-1)"},
    {"mesh out of range", [](GltfBuilder& g) { g.json["nodes"][0]["mesh"] = 5; },
     "node 0 'triangle', mesh: points past the end, there are 1 (5)"},
    {"child out of range", [](GltfBuilder& g) { g.json["nodes"][0]["children"] = {1}; },
     "node 0 'triangle', children: points past the end, there are 1 (1)"},
    {"node below itself", [](GltfBuilder& g) { g.json["nodes"][0]["children"] = {0}; },
     "node 0 'triangle': is its own ancestor (a cycle of nodes)"},
    {"cycle of two",
     [](GltfBuilder& g) {
       g.json["nodes"][0]["children"] = {1};
       g.add_node({{"children", {0}}});
     },
     "node 0 'triangle': is its own ancestor (a cycle of nodes)"},
    {"two parents",
     [](GltfBuilder& g) {
       g.add_node({{"children", {0}}});
       g.add_node({{"children", {0}}});
     },
     "node 0 'triangle': has two parents (1 and 2)"},
    {"node twice in the scene",
     [](GltfBuilder& g) {
       g.json["scenes"] = {{{"nodes", {0, 0}}}};
     },
     "node 0 'triangle': is in the scene twice"},
    {"short matrix",
     [](GltfBuilder& g) {
       g.json["nodes"][0]["matrix"] = {1, 2};
     },
     "node 0 'triangle', matrix: is not an array of 16 numbers ([1,2])"},
    {"zero rotation",
     [](GltfBuilder& g) {
       g.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
     },
     "node 0 'triangle', rotation: has no direction (length 0)"},
    {"translation beyond floats",
     [](GltfBuilder& g) {
       g.json["nodes"][0]["translation"] = {1e39, 0, 0};
     },
     "node 0 'triangle', translation: is out of range (1e+39)"},
    {"transforms that overflow together",
     [](GltfBuilder& g) {
       g.json["nodes"][0]["scale"] = {1e30, 1e30, 1e30};
       g.json["nodes"][0]["children"] = {1};
       g.add_node({{"scale", {1e30, 1, 1}}});
     },
     "node 1: its position in the world is too large for a float (1e+60)"},
    {"vertices that overflow",
     [](GltfBuilder& g) {
       primitive(g)["attributes"]["POSITION"] = g.add_positions({0, 0, 0, 1e30f, 0, 0, 0, 1e30f, 0});
       g.json["nodes"][0]["scale"] = {1e9, 1e9, 1e9};
     },
     "node 0 'triangle': has a coordinate in the world that is too large for a float (x inf)"},
    {"NaN position",
     [](GltfBuilder& g) {
       primitive(g)["attributes"]["POSITION"] = g.add_positions({0, 0, 0, 1, NAN, 0, 0, 1, 0});
     },
     "mesh 0, primitive 0, attribute POSITION: value is not finite (nan in element 1)"},
    {"infinite position",
     [](GltfBuilder& g) {
       primitive(g)["attributes"]["POSITION"] = g.add_positions({0, 0, 0, 1, 0, 0, 0, 1, INFINITY});
     },
     "mesh 0, primitive 0, attribute POSITION: value is not finite (inf in element 2)"},
    {"position of two components",
     [](GltfBuilder& g) {
       primitive(g)["attributes"]["POSITION"] = g.add_floats({0, 0, 1, 0, 0, 1}, "VEC2", 2);
     },
     "mesh 0, primitive 0, attribute POSITION: accessor 2 has the wrong type (2 components)"},
    {"index out of range",
     [](GltfBuilder& g) {
       primitive(g)["indices"] = g.add_indices({0, 1, 70});
     },
     "mesh 0, primitive 0, indices: index is out of range, there are 3 vertices (70 at 2)"},
    {"float indices",
     [](GltfBuilder& g) {
       primitive(g)["indices"] = g.add_floats({0, 1, 2}, "SCALAR", 1);
     },
     "mesh 0, primitive 0, indices: component type cannot hold indices (5126)"},
    {"unknown mode", [](GltfBuilder& g) { primitive(g)["mode"] = 7; },
     "mesh 0, primitive 0, mode: is out of range (7)"},
    {"attribute out of range", [](GltfBuilder& g) { primitive(g)["attributes"]["NORMAL"] = 9; },
     "mesh 0, primitive 0, attribute NORMAL: points past the end, there are 2 (9)"},
    {"attribute of another count",
     [](GltfBuilder& g) {
       primitive(g)["attributes"]["NORMAL"] = g.add_positions({0, 0, 1});
     },
     "mesh 0, primitive 0, attribute NORMAL: has a different number of elements than POSITION, which has 3 (1)"},
    {"material out of range", [](GltfBuilder& g) { primitive(g)["material"] = 0; },
     "mesh 0, primitive 0, material: points past the end, there are 0 (0)"},
    {"accessor past its view", [](GltfBuilder& g) { g.json["accessors"][0]["count"] = 4; },
     "mesh 0, primitive 0, attribute POSITION: accessor ends past buffer view 0 (4 elements of 12 bytes, stride 12, at "
     "byte 0 of 36)"},
    {"accessor that would wrap around", [](GltfBuilder& g) { g.json["accessors"][0]["byteOffset"] = 9007199254740992; },
     "mesh 0, primitive 0, attribute POSITION: accessor ends past buffer view 0 (3 elements of 12 bytes, stride 12, at "
     "byte 9007199254740992 of 36)"},
    {"huge count", [](GltfBuilder& g) { g.json["accessors"][0]["count"] = 4000000000; },
     "mesh 0, primitive 0, attribute POSITION: accessor ends past buffer view 0 (4000000000 elements in 36 bytes)"},
    {"huge count without data",
     [](GltfBuilder& g) {
       g.json["accessors"][0]["count"] = 4000000000;
       g.json["accessors"][0].erase("bufferView");
     },
     "mesh 0, primitive 0: accessors without a buffer view have more than 4194304 elements together (4000000000)"},
    {"many accessors without data",
     [](GltfBuilder& g) {
       g.json["accessors"][0]["count"] = 1u << 20;
       g.json["accessors"][0].erase("bufferView");
       primitive(g).erase("indices");
       for (int i = 1; i < 5; ++i) g.json["meshes"][0]["primitives"].push_back(primitive(g));
     },
     "mesh 0, primitive 4: accessors without a buffer view have more than 4194304 elements together (5242880)"},
    {"geometry that would fill the memory",
     [](GltfBuilder& g) {
       // Strips of 100 000 vertices: with flat normals 3 corners of 64 bytes and the vertex's own 60 for each.
       const int position = g.append("accessors", {{"bufferView", g.add_view(std::vector<int8_t>(400000), 4)},
                                                   {"componentType", byte_type},
                                                   {"type", "VEC3"},
                                                   {"count", 100000}});
       const Json strip = {{"mode", 5}, {"attributes", {{"POSITION", position}}}};
       for (int i = 0; i < 700; ++i) g.json["meshes"][0]["primitives"].push_back(strip);
     },
     "mesh 0, primitive 682: the geometry up to here needs more than 17179869184 bytes (17186400372)"},
    {"elements that overlap", [](GltfBuilder& g) { g.json["bufferViews"][0]["byteStride"] = 4; },
     "mesh 0, primitive 0, attribute POSITION: byteStride of buffer view 0 is less than an element of 12 bytes (4)"},
    {"matrix that is not affine",
     [](GltfBuilder& g) { g.json["nodes"][0]["matrix"] = {1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2}; },
     "node 0 'triangle', matrix: its last row is not 0, 0, 0, 1 ([0.5,0,0,2])"},
    {"scene that names a child",
     [](GltfBuilder& g) {
       g.add_node({{"children", {0}}});
       g.json["scenes"] = {{{"nodes", {0}}}};
     },
     "scene 0, nodes: names a node that is below another (0)"},
    {"line break in an attribute", [](GltfBuilder& g) { primitive(g)["attributes"]["A\nB"] = 9; },
     "mesh 0, primitive 0, attribute A\\nB: points past the end, there are 2 (9)"},
    {"line break in alphaMode",
     [](GltfBuilder& g) {
       g.json["materials"] = {{{"alphaMode", "X\nY"}}};
       primitive(g)["material"] = 0;
     },
     "material 0, alphaMode: is not OPAQUE, MASK or BLEND (X\\nY)"},
    {"control characters in a name",
     [](GltfBuilder& g) {
       g.json["nodes"][0]["name"] = "x\x1b[31m\x7f\u0085\u2028\u00e9";
       g.json["nodes"][0]["mesh"] = 7;
     },
     "node 0 'x\\u001b[31m\\u007f\\u0085\\u2028\u00e9', mesh: points past the end, there are 1 (7)"},
    {"emissive beyond a pack",
     [](GltfBuilder& g) {
       g.json["materials"] = {{{"emissiveFactor", {0, 2e6, 0}},
                               {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 1e9}}}}}}};
       primitive(g)["material"] = 0;
     },
     "material 0, emissiveFactor: times emissiveStrength is above 1e+12 (2e+15)"},
    {"colour of a light beyond a pack",
     [](GltfBuilder& g) {
       g.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"color", {0, 2e6, 0}}}};
     },
     "light 0, color: is out of range (2000000.0)"},
    {"intensity of a light beyond a pack",
     [](GltfBuilder& g) {
       g.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 2e12}}};
     },
     "light 0, intensity: is out of range (2000000000000.0)"},
    {"unknown camera",
     [](GltfBuilder& g) {
       g.json["cameras"] = {{{"type", "fisheye"}}};
     },
     "camera 0, type: is not a camera type (\"fisheye\")"},
    {"orthographic camera without its numbers",
     [](GltfBuilder& g) {
       g.json["cameras"] = {{{"type", "orthographic"}}};
     },
     "camera 0: has no orthographic"},
    {"count beyond 32 bits", [](GltfBuilder& g) { g.json["accessors"][0]["count"] = 4294967295; },
     "accessor 0, count: is out of range (4294967295)"},
    {"count that is no number", [](GltfBuilder& g) { g.json["accessors"][0]["count"] = "3"; },
     "accessor 0, count: is not a whole number (\"3\")"},
    {"unknown component type", [](GltfBuilder& g) { g.json["accessors"][0]["componentType"] = 5130; },
     "accessor 0, componentType: is out of range (5130)"},
    {"unknown accessor type", [](GltfBuilder& g) { g.json["accessors"][0]["type"] = "VEC5"; },
     "mesh 0, primitive 0, attribute POSITION: accessor 0 has the wrong type (0 components)"},
    {"later version", [](GltfBuilder& g) { g.json["asset"]["minVersion"] = "3.0"; },
     "glTF, asset, minVersion: is not 2.x (\"3.0\")"},
    {"view past its buffer", [](GltfBuilder& g) { g.json["bufferViews"][0]["byteLength"] = 1000; },
     "mesh 0, primitive 0, attribute POSITION: buffer view 0 ends past buffer 0 (0 + 1000 of 42 bytes)"},
    {"stride that is no multiple of 4", [](GltfBuilder& g) { g.json["bufferViews"][0]["byteStride"] = 13; },
     "buffer view 0, byteStride: is not a multiple of 4 (13)"},
    {"sparse index out of range",
     [](GltfBuilder& g) {
       g.json["accessors"][0]["sparse"] = {
           {"count", 1},
           {"indices", {{"bufferView", g.add_view<uint8_t>({9})}, {"componentType", unsigned_byte_type}}},
           {"values", {{"bufferView", g.add_view<float>({0, 0, 0})}}}};
     },
     "mesh 0, primitive 0, attribute POSITION, sparse indices: index is out of range (9)"},
    {"short sparse values",
     [](GltfBuilder& g) {
       g.json["accessors"][0]["sparse"] = {
           {"count", 2},
           {"indices", {{"bufferView", g.add_view<uint8_t>({0, 1})}, {"componentType", unsigned_byte_type}}},
           {"values", {{"bufferView", g.add_view<float>({0, 0, 0})}}}};
     },
     "mesh 0, primitive 0, attribute POSITION, sparse values: accessor ends past buffer view 3 (2 elements of 12 "
     "bytes, "
     "stride 12, at byte 0 of 12)"},
    {"light out of range", [](GltfBuilder& g) { g.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0; },
     "node 0 'triangle', extensions, KHR_lights_punctual, light: points past the end, there are 0 (0)"},
    {"unknown light type",
     [](GltfBuilder& g) {
       g.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "area"}, {"name", "sky"}}};
     },
     "light 0 'sky', type: is not a light type (\"area\")"},
    {"negative intensity",
     [](GltfBuilder& g) {
       g.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", -1}}};
     },
     "light 0, intensity: is out of range (-1)"},
    {"range of nearly zero",
     [](GltfBuilder& g) {
       g.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"range", 1e-13}}};
     },
     "light 0, range: is out of range (1e-13)"},
    {"range below zero",
     [](GltfBuilder& g) {
       g.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"range", -1}}};
     },
     "light 0, range: is out of range (-1)"},
    {"visibility of another type",
     [](GltfBuilder& g) { g.json["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = "no"; },
     "node 0 'triangle', extensions, KHR_node_visibility, visible: is not true or false (\"no\")"},
    {"glossiness out of range",
     [](GltfBuilder& g) {
       g.json["materials"] = {{{"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"glossinessFactor", 2}}}}}}};
     },
     "material 0, extensions, KHR_materials_pbrSpecularGlossiness, glossinessFactor: is out of range (2)"},
    {"cone inside out",
     [](GltfBuilder& g) {
       g.json["extensions"]["KHR_lights_punctual"]["lights"] = {
           {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.25}}}}};
     },
     "light 0, spot, innerConeAngle: is wider than the outer cone (0.5)"},
    {"camera without an angle",
     [](GltfBuilder& g) {
       g.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"znear", 1}}}}};
     },
     "camera 0, perspective: has no yfov"},
    {"texture out of range",
     [](GltfBuilder& g) {
       g.json["materials"] = {{{"name", "m"}, {"normalTexture", {{"index", 0}}}}};
     },
     "material 0 'm', normalTexture, index: points past the end, there are 0 (0)"},
    {"buffer's extensions of another type",
     [](GltfBuilder& g) {
       g.bytes.clear();
       g.json["buffers"] = {{{"byteLength", 96}, {"extensions", {1}}}};
     },
     "buffer 0, extensions: is not an object ([1])"},
    {"fallback of another type",
     [](GltfBuilder& g) {
       g.bytes.clear();
       g.json["buffers"] = {{{"byteLength", 96}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", "yes"}}}}}}};
     },
     "buffer 0, extensions, EXT_meshopt_compression, fallback: is not true or false (\"yes\")"},
};

TEST(BadInput, IsRefusedWithPlaceFaultAndValue) {
  for (const Case& each : cases) {
    GltfBuilder gltf = one_triangle();
    each.spoil(gltf);
    const std::filesystem::path path = gltf.save("bad");
    EXPECT_EQ(error_of(path), path.string() + ": " + each.expected) << each.name;
  }
}

TEST(BadInput, OfAKeyThatIsNotReadChangesNothing) {
  GltfBuilder gltf = one_triangle();
  gltf.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}, {"xmag", "wide"}}}}};
  EXPECT_EQ(error_of(gltf.save()), "");
}

/// Values of every type in place of each value of a file that has nearly everything.
void replace_each(Json& at, const std::function<void()>& with_each) {
  for (Json& each : at) {
    if (each.is_structured()) replace_each(each, with_each);
    const Json kept = each;
    for (const Json& value : {Json(), Json(true), Json(-1), Json(0.5), Json("text"), Json{1}, Json{{"a", 1}}}) {
      each = value;
      with_each();
    }
    each = kept;
  }
}

TEST(BadInput, IsOneLineWhateverTypeAValueHas) {
  GltfBuilder gltf = one_triangle();
  gltf.json["scenes"] = {{{"nodes", {0}}, {"name", "all"}, {"extensions", Json::object()}}};
  gltf.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}, {"zfar", 9}, {"xmag", 1}, {"ymag", 1}}}}};
  gltf.json["nodes"][0].update({{"camera", 0}, {"rotation", {0, 0, 0, 1}}, {"scale", {1, 1, 1}}, {"weights", {0}}});
  gltf.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 1}}, {"metallicFactor", 1}}},
                             {"alphaMode", "MASK"},
                             {"emissiveFactor", {0, 0, 0}},
                             {"extensions", {{"KHR_materials_unlit", {{"a", 1}}}}}}};
  gltf.json["samplers"] = {{{"magFilter", 9729}, {"extensions", {{"a", 1}}}}};
  primitive(gltf).update({{"material", 0}, {"mode", 4}, {"targets", {{{"POSITION", 0}}}}});
  gltf.json["meshes"][0]["weights"] = {0.5};
  gltf.json["extensionsUsed"] = {"KHR_materials_unlit"};
  Json whole = Json::parse(gltf.text());
  whole["buffers"][0]["extensions"]["EXT_meshopt_compression"]["fallback"] = false;
  whole["bufferViews"][0]["target"] = 34962;
  const std::filesystem::path path = scratch_folder() / "typed.gltf";
  size_t refused = 0;
  replace_each(whole, [&] {
    write_bytes(path, whole.dump());
    const std::string line = error_of(path);  // another exception fails the test
    refused += !line.empty();
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    EXPECT_TRUE(line.empty() || line.rfind(path.string() + ": ", 0) == 0) << line;
    EXPECT_EQ(line.find("json.exception"), std::string::npos) << line << whole;  // the net, not a check
  });
  EXPECT_GT(refused, 100u);
}

TEST(BadInput, OnlyWarnsOfUnknownExtensionsThatAreOptional) {
  GltfBuilder gltf = one_triangle();
  gltf.json["extensionsUsed"] = {"KHR_materials_ior", "KHR_lights_punctual"};
  Warnings warnings;
  EXPECT_EQ(gltf.import(&warnings).instances.size(), 1u);
  ASSERT_EQ(warnings.lines().size(), 1u);
  EXPECT_NE(warnings.lines()[0].find("extensionsUsed: unknown extension is ignored (KHR_materials_ior)"),
            std::string::npos);
}

TEST(BadInput, IsWarnedOfInOneLineWithAFewNames) {
  GltfBuilder gltf = one_triangle();
  for (int i = 0; i < 100000; ++i) gltf.json["extensionsUsed"].push_back("E" + std::to_string(i));
  Warnings warnings;
  const std::filesystem::path path = gltf.save("many");
  Scene scene;
  import_gltf(path, scene, warnings);
  EXPECT_EQ(warnings.lines(),
            std::vector<std::string>{path.string() +
                                     ": extensionsUsed: unknown extension is ignored (E0, E1, E2 and 99997 more)"});
}

TEST(Message, IsCutBetweenCharacters) {
  EXPECT_EQ(shortened("\u00e9\u00e9", 4), "\u00e9\u00e9");
  EXPECT_EQ(shortened("\u00e9\u00e9\u00e9\u00e9", 6), "\u00e9...");  // the second would end at byte 4
  EXPECT_EQ(printable("a\xff\xc3"), "a\\xff\\xc3");
}

TEST(BadInput, IsWarnedOfOnceHoweverOftenItOccurs) {
  GltfBuilder gltf = one_triangle();
  gltf.json["nodes"][0]["scale"] = {0, 0, 0};
  for (int i = 0; i < 9; ++i) gltf.add_node({{"mesh", 0}, {"scale", {0, 0, 0}}});
  Warnings warnings;
  gltf.import(&warnings);
  ASSERT_EQ(warnings.lines().size(), 1u);
  EXPECT_NE(warnings.lines()[0].find("node 0 'triangle' (and 9 more): a mesh whose scale is zero"), std::string::npos);
}

}  // namespace
}  // namespace chandelier::baker::test
