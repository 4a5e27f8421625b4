// SPDX-License-Identifier: Apache-2.0
// One grid per mesh, so that what is shared between its primitives stays shared. Values stay floats: multiples of a
// power of two are exact in them, and the codecs find the zeros.
#include "quantize.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

#include "octahedral.h"

namespace chandelier::baker {
namespace {

/// The measured errors of a mesh's vertices: maxima, so their order does not matter.
struct Errors {
  double distance_ls = 0;
  double chord = 0;  // between unit vectors
  double uv = 0;

  void include(const Errors& other) {
    distance_ls = std::max(distance_ls, other.distance_ls);
    chord = std::max(chord, other.chord);
    uv = std::max(uv, other.uv);
  }
};

/// Which attributes are read. For texture coordinates: the largest error of an image's coordinates per unit of error of
/// the mesh's.
struct Needs {
  bool tangent = false;
  double uv0 = 0, uv1 = 0;  // 0: not read
};

/// The larger error along the image's u or v if the mesh's u and v are each off by 1.
double uv_scale(const UvTransform& transform) {
  const auto sum = [](const glm::vec3& row) { return std::abs(double{row.x}) + std::abs(double{row.y}); };
  return std::max(sum(transform[0]), sum(transform[1]));
}

Needs needs_of(const Material& material) {
  Needs needs;
  needs.tangent = material.normal.texture != no_index;
  for (const TextureUse* use : {&material.base_color, &material.metallic_roughness, &material.normal,
                                &material.occlusion, &material.emissive_map}) {
    if (use->texture == no_index) continue;
    double& scale = use->uv1 ? needs.uv1 : needs.uv0;
    scale = std::max({scale, uv_scale(use->uv_transform), 1e-30});  // coordinates scaled by 0 are read too
  }
  return needs;
}

/// Rounds to multiples of a power of two; 0 keeps the value. A float that is coarser than the step is already such a
/// multiple.
class Grid {
 public:
  explicit Grid(double step) : step_(step), per_step_(step > 0 ? 1 / step : 0) {}

  float snap(float value) const {
    constexpr double most_steps = 16777216;  // above, floats themselves are multiples
    const double steps = double{value} * per_step_;
    if (step_ == 0 || !(std::abs(steps) < most_steps)) return value;
    return static_cast<float>(std::nearbyint(steps) * step_) + 0.0f;  // no negative zero
  }

  template <typename Vector>
  Vector snap_all(Vector v) const {
    for (int i = 0; i < Vector::length(); ++i) v[i] = snap(v[i]);
    return v;
  }

 private:
  double step_, per_step_;
};

struct Coding {
  Grid position, uv0, uv1;
  int normal_bits, tangent_bits;
};

/// Finer by a power of two where the image's coordinates are a multiple of the mesh's (KHR_texture_transform).
Grid uv_grid(int bits, double scale) {
  if (bits == 0) return Grid(0);
  return Grid(std::exp2(-bits - std::ceil(std::log2(std::max(scale, 1.0)))));
}

double chord(const glm::vec3& a, const glm::vec3& b) {
  return glm::distance(glm::normalize(glm::dvec3(a)), glm::normalize(glm::dvec3(b)));
}

glm::vec2 code_uv(const glm::vec2& uv, const Grid& grid, double scale, Errors& errors) {
  if (scale == 0) return glm::vec2(0);
  const glm::vec2 out = grid.snap_all(uv);
  errors.uv = std::max(errors.uv, scale * std::max(std::abs(double{out.x} - uv.x), std::abs(double{out.y} - uv.y)));
  return out;
}

PackedVertex code(const Vertex& in, const Coding& coding, const Needs& needs, Errors& errors) {
  PackedVertex out;
  out.position_ls = coding.position.snap_all(in.position_ls);
  errors.distance_ls =
      std::max(errors.distance_ls, glm::distance(glm::dvec3(out.position_ls), glm::dvec3(in.position_ls)));
  pack::VertexAttributes& to = out.attributes;
  to.normal_ls = pack::encode_normal(in.normal_ls, coding.normal_bits);
  errors.chord = std::max(errors.chord, chord(pack::decode_normal(to.normal_ls), in.normal_ls));
  to.tangent_ls = 0;
  if (needs.tangent) {
    to.tangent_ls = pack::encode_tangent(in.tangent_ls, coding.tangent_bits);
    errors.chord = std::max(errors.chord, chord(pack::decode_tangent(to.tangent_ls), in.tangent_ls));
  }
  to.uv0 = code_uv(in.uv0, coding.uv0, needs.uv0, errors);
  to.uv1 = code_uv(in.uv1, coding.uv1, needs.uv1, errors);
  to.color = in.color;
  return out;
}

PackedPrimitive code(Primitive&& in, const Coding& coding, const Needs& needs, Errors& errors) {
  using Range = tbb::blocked_range<size_t>;
  PackedPrimitive out;
  out.vertices.resize(in.vertices.size());
  errors = tbb::parallel_reduce(
      Range(0, in.vertices.size(), 4096), errors,
      [&](const Range& range, Errors sum) {
        for (size_t i = range.begin(); i < range.end(); ++i) {
          out.vertices[i] = code(in.vertices[i], coding, needs, sum);
        }
        return sum;
      },
      [](Errors a, const Errors& b) { return a.include(b), a; });
  out.skin_vertices = std::move(in.skin_vertices);
  out.indices = std::move(in.indices);
  out.material = in.material;
  in = {};
  return out;
}

double longest_side(const Mesh& mesh) {
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (const Primitive& primitive : mesh.primitives) {
    for (const Vertex& vertex : primitive.vertices) {
      low = glm::min(low, glm::dvec3(vertex.position_ls));
      high = glm::max(high, glm::dvec3(vertex.position_ls));
    }
  }
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z, 0.0});
}

/// Per node: the largest scale of its keys; below 0 where none is animated.
std::vector<double> key_scales(const Scene& scene) {
  std::vector<double> out(scene.nodes.size(), -1);
  for (const Animation& animation : scene.animations) {
    for (const AnimationChannel& channel : animation.channels) {
      if (channel.path != AnimationPath::scale) continue;
      const bool cubic = channel.interpolation == Interpolation::cubic_spline;  // tangent, value, tangent
      for (size_t i = 0; i < channel.values.size(); ++i) {
        if (cubic && i / 3 % 3 != 1) continue;
        out[channel.node] = std::max(out[channel.node], std::abs(double{channel.values[i]}));
      }
    }
  }
  return out;
}

/// How much a node stretches what it carries.
struct Stretch {
  glm::dmat4 world{1};  // at rest
  bool grows = false;   // whether its scale, or that of a node above it, is animated
  double most = 0;      // if it grows: the largest factor at any keys of it and of those above
};

std::vector<Stretch> stretches_of(const Scene& scene) {
  const std::vector<double> keys = key_scales(scene);
  std::vector<Stretch> out;
  for (size_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    const Stretch above = node.parent == no_index ? Stretch{.most = 1} : out[node.parent];
    const double own = std::max(largest_scale(node.parent_from_local), keys[n]);
    out.push_back({above.world * node.parent_from_local, above.grows || keys[n] >= 0, above.most * own});
  }
  return out;
}

double scale_of(const MeshInstance& instance, const std::vector<Stretch>& nodes) {
  const double rest = largest_scale(instance.world_from_local);
  if (instance.node == no_index || !nodes[instance.node].grows) return rest;
  const Stretch& node = nodes[instance.node];
  if (node.world == instance.world_from_local) return std::max(rest, node.most);
  return std::max(rest, node.most * largest_scale(glm::inverse(node.world) * instance.world_from_local));  // a copy
}

double scale_of(const Joint& joint, const std::vector<Stretch>& nodes) {
  const glm::dmat4 bind(joint.joint_from_bind);
  const Stretch& node = nodes[joint.node];
  return std::max(largest_scale(node.world * bind), node.grows ? node.most * largest_scale(bind) : 0);
}

/// Per mesh: the most that an instance stretches it, at rest and at animated scales; below 0 where there is no
/// instance.
std::vector<double> largest_scales(const Scene& scene) {
  const std::vector<Stretch> nodes = stretches_of(scene);
  std::vector<double> out(scene.meshes.size(), -1);
  for (const MeshInstance& instance : scene.instances) {
    double& largest = out[instance.mesh];
    largest = std::max(largest, scale_of(instance, nodes));
    if (instance.skin == no_index) continue;
    for (const Joint& joint : scene.skins[instance.skin].joints) largest = std::max(largest, scale_of(joint, nodes));
  }
  return out;
}

}  // namespace

double largest_scale(const glm::dmat4& matrix) {
  // The square root of the largest eigenvalue of AᵀA, a symmetric matrix: Smith 1961, Eigenvalues of a symmetric 3 × 3
  // matrix.
  const glm::dmat3 a(matrix);
  const glm::dmat3 m = glm::transpose(a) * a;
  const double mean = (m[0][0] + m[1][1] + m[2][2]) / 3;
  double off = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) off += std::pow(m[i][j] - (i == j ? mean : 0), 2);
  }
  const double p = std::sqrt(off / 6);
  if (!(p > 0)) return std::sqrt(mean);
  const double r = std::clamp(glm::determinant((m - glm::dmat3(mean)) / p) / 2, -1.0, 1.0);
  return std::sqrt(mean + 2 * p * std::cos(std::acos(r) / 3));
}

double grid_step(double error_m, double scale, double extent_ls) {
  constexpr double step_count = 16384;
  // Half a step along each axis: √3/2 of it in all. The margin covers rounding here and in the instance's floats.
  const double most = std::min(2 * error_m / (std::sqrt(3.0) * scale) * (1 - 1e-6), extent_ls / step_count);
  if (!(most >= 1e-30) || !std::isfinite(most)) return 0;
  return std::exp2(std::floor(std::log2(most)));
}

std::vector<PackedMesh> quantize(Scene& scene, const QuantizeSettings& settings, pack::BakeInfo& info) {
  const std::vector<double> scales = largest_scales(scene);
  std::vector<PackedMesh> out(scene.meshes.size());
  std::vector<Errors> errors(scene.meshes.size());
  tbb::parallel_for(size_t{0}, scene.meshes.size(), [&](size_t m) {
    std::vector<Primitive>& primitives = scene.meshes[m].primitives;
    if (scales[m] >= 0) {
      const double step = settings.position_error_m > 0
                              ? grid_step(settings.position_error_m, scales[m], longest_side(scene.meshes[m]))
                              : 0;
      for (Primitive& primitive : primitives) {
        const Needs needs = needs_of(scene.materials[primitive.material]);
        const Coding coding{Grid(step), uv_grid(settings.uv_bits, needs.uv0), uv_grid(settings.uv_bits, needs.uv1),
                            settings.normal_bits, std::min(settings.normal_bits, 15)};
        out[m].primitives.push_back(code(std::move(primitive), coding, needs, errors[m]));
      }
    }
    primitives = {};
  });
  Errors all;
  for (size_t m = 0; m < errors.size(); ++m) {
    errors[m].distance_ls *= std::max(scales[m], 0.0);
    all.include(errors[m]);
  }
  // Rounded up to a float, so that the stated error is an upper bound.
  const auto up = [](double value) { return value > 0 ? std::nextafter(static_cast<float>(value), INFINITY) : 0.0f; };
  info.position_error_m = up(all.distance_ls);
  info.normal_error_rad = up(2 * std::asin(std::min(all.chord / 2, 1.0)));
  info.uv_error = up(all.uv);
  return out;
}

}  // namespace chandelier::baker
