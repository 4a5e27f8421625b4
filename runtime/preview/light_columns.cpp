// SPDX-License-Identifier: Apache-2.0
#include "preview/light_columns.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <charconv>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>

#include "light_range.h"

namespace chandelier::preview {
namespace {

constexpr int64_t most_stride = int64_t{1} << 31;
constexpr float most_coordinate_m = 1e12f;
constexpr float most_intensity = 1e12f, most_color = 1e6f, most_radius_m = 1e6f;  // a pack's limits
constexpr float least_cone_rad = 1e-6f, most_cone_rad = std::numbers::pi_v<float> / 2.0f;
constexpr uint32_t most_pixels = 65536;

// The shortest that is read back as the same.
std::string to_text(float value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

[[noreturn]] void fail(const std::string& where, const std::string& what, const std::string& value) {
  throw InputError(where + ": " + what + " (" + value + ")");
}
[[noreturn]] void fail(const std::string& where, const std::string& what, float value) {
  fail(where, what, to_text(value));
}
[[noreturn]] void fail(const std::string& where, const std::string& what, uint32_t value) {
  fail(where, what, std::to_string(value));
}

// A light's values in one column, or the default.
template <typename Value, size_t parts = 1>
class Column {
 public:
  using Values = std::array<Value, parts>;

  Column(const ChandelierPreviewColumn& column, const char* name, const Values& missing)
      : first_(static_cast<const char*>(column.first)), stride_(column.stride_bytes), name_(name), missing_(missing) {
    constexpr auto size = static_cast<int64_t>(sizeof(Values));
    if (first_ && stride_ != 0 && (stride_ < size || stride_ > most_stride))
      fail(name_, "stride_bytes is neither 0 nor from " + std::to_string(size) + " to 2^31", std::to_string(stride_));
  }

  bool is_given() const { return first_ != nullptr; }
  const char* name() const { return name_; }
  Values operator[](uint32_t light) const {
    Values values = missing_;
    if (first_) std::memcpy(values.data(), first_ + int64_t{light} * stride_, sizeof values);
    return values;
  }

 private:
  const char* first_;
  int64_t stride_;
  const char* name_;
  Values missing_;
};

template <typename Value, size_t parts>
std::string place(const Column<Value, parts>& column, uint32_t light) {
  return "light " + std::to_string(light) + ", " + column.name();
}

template <size_t parts>
std::array<float, parts> within(const Column<float, parts>& column, uint32_t light, float least, float most) {
  const std::array<float, parts> values = column[light];
  for (const float value : values)
    if (!(value >= least && value <= most))
      fail(place(column, light), "is not from " + to_text(least) + " to " + to_text(most), value);
  return values;
}

// Left as it is where it has unit length already.
glm::vec3 direction(const std::array<float, 3>& values, const std::string& where) {
  const glm::dvec3 given(values[0], values[1], values[2]);
  const double length = std::sqrt(glm::dot(given, given));
  if (!(length > 0.0 && std::isfinite(length))) fail(where, "has no direction", static_cast<float>(length));
  if (std::abs(length - 1.0) < 1e-5) return {values[0], values[1], values[2]};
  return glm::vec3(given / length);
}

struct Columns {
  explicit Columns(const ChandelierPreviewLights& lights)
      : position(lights.position, "position", {}),
        direction(lights.direction, "direction", {}),
        type(lights.type, "type", {CHANDELIER_PREVIEW_POINT}),
        intensity(lights.intensity, "intensity", {1.0f}),
        color(lights.color, "color", {1.0f, 1.0f, 1.0f}),
        range_m(lights.range_m, "range_m", {}),
        radius_m(lights.radius_m, "radius_m", {}),
        spot_outer_rad(lights.spot_outer_rad, "spot_outer_rad", {0.7854f}),
        flags(lights.flags, "flags", {}),
        priority(lights.priority, "priority", {128}),
        group(lights.group, "group", {-1}) {}

  Column<float, 3> position, direction;
  Column<uint8_t> type;
  Column<float> intensity;
  Column<float, 3> color;
  Column<float> range_m, radius_m, spot_outer_rad;
  Column<uint8_t> flags, priority;
  Column<int32_t> group;
};

// baker/bake/lights.cpp:make_lights, of what a selection looks at.
void place_light(const Columns& columns, uint32_t number, float range_threshold_lx, pack::Light& light) {
  if (light.type != pack::LightType::point)
    light.direction_ws = direction(columns.direction[number], place(columns.direction, number));
  if (light.type == pack::LightType::directional) {
    light.range_source = pack::RangeSource::unbounded;
    return;
  }
  const auto position = within(columns.position, number, -most_coordinate_m, most_coordinate_m);
  light.position_ws = {position[0], position[1], position[2]};
  light.range_m = within(columns.range_m, number, 0.0f, FLT_MAX)[0];
  if (light.range_m == 0.0f) {
    light.range_source = pack::RangeSource::derived;
    light.range_m = pack::derived_range_m(light.intensity, light.color, range_threshold_lx);
  }
  if (light.type == pack::LightType::spot)
    light.outer_cone_cos = std::cos(within(columns.spot_outer_rad, number, least_cone_rad, most_cone_rad)[0]);
}

}  // namespace

Lights read_lights(const ChandelierPreviewLights& lights, float range_threshold_lx) {
  if (lights.count > CHANDELIER_PREVIEW_MOST_LIGHTS)
    fail("lights", "count is above " + std::to_string(CHANDELIER_PREVIEW_MOST_LIGHTS), lights.count);
  const Columns columns(lights);
  if (lights.count > 0 && !columns.position.is_given()) throw InputError("position: is missing");
  Lights out;
  out.lights.reserve(lights.count);
  out.numbers.reserve(lights.count);
  for (uint32_t i = 0; i < lights.count; ++i) {
    pack::Light light;
    const uint8_t type = columns.type[i][0];
    if (type > CHANDELIER_PREVIEW_DIRECTIONAL) fail(place(columns.type, i), "is none of 0, 1 and 2", uint32_t{type});
    const auto color = within(columns.color, i, 0.0f, most_color);
    light.type = static_cast<pack::LightType>(type);
    light.intensity = within(columns.intensity, i, 0.0f, most_intensity)[0];
    light.color = {color[0], color[1], color[2]};
    if (light.intensity == 0.0f || std::max({color[0], color[1], color[2]}) == 0.0f) continue;
    light.direction_ws = {0.0f, 0.0f, -1.0f};
    light.inner_cone_cos = 1.0f;
    light.outer_cone_cos = -1.0f;
    light.dynamic = (columns.flags[i][0] & CHANDELIER_PREVIEW_DYNAMIC) != 0;
    light.unclustered = (columns.flags[i][0] & CHANDELIER_PREVIEW_OWN_MAP) != 0;
    light.shadowless = (columns.flags[i][0] & CHANDELIER_PREVIEW_NO_SHADOW) != 0;
    light.radius_m = within(columns.radius_m, i, 0.0f, most_radius_m)[0];
    light.priority = columns.priority[i][0];
    const int32_t group = columns.group[i][0];
    light.group = group < 0 ? 0 : static_cast<uint32_t>(group) + 1;
    place_light(columns, i, range_threshold_lx, light);
    out.lights.push_back(light);
    out.numbers.push_back(i);
  }
  return out;
}

void check_size(uint32_t struct_bytes, size_t expected, const char* what) {
  if (struct_bytes != expected)
    fail(what, "struct_bytes is not " + std::to_string(expected) + ", so it is of another version", struct_bytes);
}

Recipe read_recipe(const ChandelierPreviewSettings& settings) {
  const auto choice = [](const char* name, uint32_t value, uint32_t most) {
    if (value > most) fail(name, "is above " + std::to_string(most), value);
    return value;
  };
  Recipe recipe;
  recipe.select = static_cast<Select>(choice("select", settings.select, static_cast<uint32_t>(Select::light_clusters)));
  recipe.filter = static_cast<Filter>(choice("filter", settings.filter, static_cast<uint32_t>(Filter::pcss)));
  recipe.distance_scaling = static_cast<DistanceScaling>(
      choice("distance_scaling", settings.distance_scaling, static_cast<uint32_t>(DistanceScaling::none)));
  recipe.dynamic_lights = static_cast<DynamicLights>(
      choice("dynamic_lights", settings.dynamic_lights, static_cast<uint32_t>(DynamicLights::own)));
  recipe.face_size_px = settings.face_size_px;
  recipe.d_init_m = settings.d_init_m;
  recipe.z_far_m = settings.z_far_m;
  recipe.reference_share = settings.reference_share;
  if (const auto why_not = refusal(recipe)) throw InputError(*why_not);
  const float lux = settings.range_threshold_lx;
  if (!(lux > 0.0f && std::isfinite(lux))) fail("range_threshold_lx", "is not above 0", lux);
  return recipe;
}

Budget read_budget(const ChandelierPreviewSettings& settings) {
  Budget budget;
  if (settings.max_shadow_maps != 0) budget.max_shadow_maps = settings.max_shadow_maps;
  if (settings.max_shadow_bytes != 0) budget.max_shadow_bytes = settings.max_shadow_bytes;
  return budget;
}

void read_camera(const ChandelierPreviewCamera& camera, RenderSettings& settings) {
  for (const float value : camera.eye_ws)
    if (!(std::abs(value) <= most_coordinate_m)) fail("camera, eye_ws", "is out of range", value);
  settings.camera.eye_ws = {camera.eye_ws[0], camera.eye_ws[1], camera.eye_ws[2]};
  settings.lights_out_of_view = camera.sees_all != 0;
  if (settings.lights_out_of_view) return;
  const auto& [forward_x, forward_y, forward_z] = camera.forward_ws;
  const auto& [up_x, up_y, up_z] = camera.up_ws;
  settings.camera.forward_ws = direction({forward_x, forward_y, forward_z}, "camera, forward_ws");
  settings.camera.up_ws = direction({up_x, up_y, up_z}, "camera, up_ws");
  if (!(camera.yfov_rad >= 1e-4f && camera.yfov_rad <= 3.1f))
    fail("camera, yfov_rad", "is not from 0.0001 to 3.1", camera.yfov_rad);
  if (!(camera.znear_m > 0.0f && camera.znear_m <= most_coordinate_m))
    fail("camera, znear_m", "is not above 0", camera.znear_m);
  for (const uint32_t size : {camera.width_px, camera.height_px})
    if (size == 0 || size > most_pixels) fail("camera, width_px and height_px", "is not from 1 to 65536", size);
  settings.camera.yfov_rad = camera.yfov_rad;
  settings.camera.znear_m = camera.znear_m;
  settings.width = camera.width_px;
  settings.height = camera.height_px;
}

}  // namespace chandelier::preview
