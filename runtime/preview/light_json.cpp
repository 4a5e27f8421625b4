// SPDX-License-Identifier: Apache-2.0
#include "preview/light_json.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "frame/recipe.h"

namespace chandelier::preview {
namespace {

using Json = nlohmann::json;

[[noreturn]] void fail(const std::string& where, const std::string& what, const Json& value) {
  std::string shown = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (shown.size() > 60) shown = shown.substr(0, 57) + "...";
  throw std::runtime_error((where.empty() ? "" : where + ": ") + what + " (" + shown + ")");
}

std::string inside(const std::string& where, std::string_view key) {
  return (where.empty() ? "" : where + ".") + std::string(key);
}

const Json& object_at(const Json& json, const char* key) {
  static const Json empty = Json::object();
  if (!json.contains(key)) return empty;
  if (!json[key].is_object()) fail(key, "is not an object", json[key]);
  return json[key];
}

/// A typing error would otherwise change nothing and say nothing.
void refuse_unknown(const Json& json, const std::string& where, std::span<const std::string_view> known) {
  for (const auto& [key, value] : json.items())
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      std::string names;
      for (const std::string_view name : known) names += (names.empty() ? "" : ", ") + std::string(name);
      fail(inside(where, key), "is none of " + names, value);
    }
}

float number(const Json& value, const std::string& where) {
  if (!value.is_number()) fail(where, "is not a number", value);
  const double read = value.get<double>();
  if (!(std::abs(read) <= double{std::numeric_limits<float>::max()})) fail(where, "is too large", value);
  return static_cast<float>(read);
}

int64_t whole(const Json& value, const std::string& where, int64_t least, int64_t most) {
  if (!value.is_number_integer() || value.is_number_float()) fail(where, "is not a whole number", value);
  const bool fits = value.is_number_unsigned()
                        ? value.get<uint64_t>() <= static_cast<uint64_t>(most) && value.get<int64_t>() >= least
                        : value.get<int64_t>() >= least && value.get<int64_t>() <= most;
  if (!fits) fail(where, "is not from " + std::to_string(least) + " to " + std::to_string(most), value);
  return value.get<int64_t>();
}

bool boolean(const Json& value, const std::string& where) {
  if (!value.is_boolean()) fail(where, "is not true or false", value);
  return value.get<bool>();
}

uint8_t one_of(const Json& value, const std::string& where, std::span<const std::string_view> names) {
  if (value.is_string()) {
    const auto found = std::find(names.begin(), names.end(), value.get_ref<const std::string&>());
    if (found != names.end()) return static_cast<uint8_t>(found - names.begin());
  }
  std::string all;
  for (const std::string_view name : names) all += (all.empty() ? "" : ", ") + std::string(name);
  fail(where, "is none of " + all, value);
}

void vec3(const Json& value, const std::string& where, float* out) {
  if (!value.is_array() || value.size() != 3) fail(where, "is not three numbers", value);
  for (size_t i = 0; i < 3; ++i) out[i] = number(value[i], where);
}

constexpr std::string_view type_names[]{"point", "spot", "directional"};
constexpr std::string_view column_names[]{"position", "direction", "type",           "intensity", "color",
                                          "range_m",  "radius_m",  "spot_outer_rad", "dynamic",   "cluster",
                                          "shadow",   "priority",  "group"};

/// Reads the columns of `lights`; each has one value for each light.
class Columns {
 public:
  Columns(const Json& lights, Request& request) : json_(lights), out_(request) {
    if (!json_.contains("position")) {
      if (!json_.empty()) throw std::runtime_error("lights.position: is missing");
      return;
    }
    if (!json_["position"].is_array()) fail("lights.position", "is not a list", json_["position"]);
    if (json_["position"].size() > CHANDELIER_PREVIEW_MOST_LIGHTS)
      throw std::runtime_error("lights.position: has more than " + std::to_string(CHANDELIER_PREVIEW_MOST_LIGHTS));
    out_.lights.count = static_cast<uint32_t>(json_["position"].size());
  }

  ChandelierPreviewColumn floats(const char* key, uint32_t parts) {
    if (!json_.contains(key)) return {};
    std::vector<float>& values = out_.floats.emplace_back(size_t{out_.lights.count} * parts);
    each(key, [&](const Json& value, const std::string& where, uint32_t light) {
      if (parts == 3)
        vec3(value, where, &values[size_t{3} * light]);
      else
        values[light] = value.is_null() ? 0.0f : number(value, where);
    });
    return {values.data(), static_cast<int64_t>(parts * sizeof(float))};
  }

  template <typename Read>
  ChandelierPreviewColumn bytes(const char* key, Read read) {
    if (!json_.contains(key)) return {};
    std::vector<uint8_t>& values = out_.bytes.emplace_back(out_.lights.count);
    each(key, [&](const Json& value, const std::string& where, uint32_t light) { values[light] = read(value, where); });
    return {values.data(), 1};
  }

  ChandelierPreviewColumn flags() {
    if (!json_.contains("dynamic") && !json_.contains("cluster") && !json_.contains("shadow")) return {};
    std::vector<uint8_t>& values = out_.bytes.emplace_back(out_.lights.count);
    const auto set = [&](const char* key, bool when, uint8_t flag) {
      each(key, [&](const Json& value, const std::string& where, uint32_t light) {
        if (boolean(value, where) == when) values[light] |= flag;
      });
    };
    set("dynamic", true, CHANDELIER_PREVIEW_DYNAMIC);
    set("cluster", false, CHANDELIER_PREVIEW_OWN_MAP);
    set("shadow", false, CHANDELIER_PREVIEW_NO_SHADOW);
    return {values.data(), 1};
  }

  ChandelierPreviewColumn groups() {
    if (!json_.contains("group")) return {};
    out_.groups.assign(out_.lights.count, -1);
    each("group", [&](const Json& value, const std::string& where, uint32_t light) {
      if (!value.is_null()) out_.groups[light] = static_cast<int32_t>(whole(value, where, -1, INT32_MAX));
    });
    return {out_.groups.data(), sizeof(int32_t)};
  }

 private:
  template <typename Visit>
  void each(const char* key, Visit visit) {
    if (!json_.contains(key)) return;
    const Json& column = json_[key];
    const std::string where = inside("lights", key);
    if (!column.is_array()) fail(where, "is not a list", column);
    if (column.size() != out_.lights.count)
      fail(where, "has not one value for each of " + std::to_string(out_.lights.count) + " lights", column.size());
    for (uint32_t light = 0; light < out_.lights.count; ++light)
      visit(column[light], where + "[" + std::to_string(light) + "]", light);
  }

  const Json& json_;
  Request& out_;
};

void read_lights(const Json& json, Request& request) {
  refuse_unknown(json, "lights", column_names);
  ChandelierPreviewLights& lights = request.lights;
  lights.struct_bytes = sizeof lights;
  Columns columns(json, request);
  lights.position = columns.floats("position", 3);
  lights.direction = columns.floats("direction", 3);
  lights.type = columns.bytes("type", [](const Json& v, const std::string& w) { return one_of(v, w, type_names); });
  lights.intensity = columns.floats("intensity", 1);
  lights.color = columns.floats("color", 3);
  lights.range_m = columns.floats("range_m", 1);
  lights.radius_m = columns.floats("radius_m", 1);
  lights.spot_outer_rad = columns.floats("spot_outer_rad", 1);
  lights.flags = columns.flags();
  lights.priority = columns.bytes(
      "priority", [](const Json& v, const std::string& w) { return static_cast<uint8_t>(whole(v, w, 0, 255)); });
  lights.group = columns.groups();
  if (!json.contains("range_m")) return;
  for (size_t light = 0; light < json["range_m"].size(); ++light) {
    const bool directional = json.contains("type") && json["type"][light] == "directional";
    request.zero_ranges += !directional && json["range_m"][light] == 0;
  }
}

// The answers up to that one, which are those that the C interface knows.
template <typename Choice>
std::vector<std::string_view> names_up_to(Choice last) {
  std::vector<std::string_view> names;
  for (const Answer& each : answers_of(last).first(static_cast<size_t>(last) + 1)) names.push_back(each.name);
  return names;
}

void read_settings(const Json& json, ChandelierPreviewSettings& settings) {
  constexpr std::string_view known[]{
      "select",  "filter",          "distance_scaling",   "dynamic_lights",  "face_size_px",    "d_init_m",
      "z_far_m", "reference_share", "range_threshold_lx", "max_shadow_maps", "max_shadow_bytes"};
  refuse_unknown(json, "settings", known);
  chandelier_preview_defaults(&settings);
  const auto choose = [&](const char* key, std::span<const std::string_view> names, uint32_t& out) {
    if (json.contains(key)) out = one_of(json[key], inside("settings", key), names);
  };
  const auto measure = [&](const char* key, float& out) {
    if (json.contains(key)) out = number(json[key], inside("settings", key));
  };
  const auto count = [&](const char* key, auto& out, int64_t most) {
    if (json.contains(key))
      out = static_cast<std::remove_reference_t<decltype(out)>>(whole(json[key], inside("settings", key), 0, most));
  };
  choose("select", names_up_to(Select::light_clusters), settings.select);
  choose("filter", names_up_to(Filter::pcss), settings.filter);
  choose("distance_scaling", names_up_to(DistanceScaling::none), settings.distance_scaling);
  choose("dynamic_lights", names_up_to(DynamicLights::own), settings.dynamic_lights);
  measure("d_init_m", settings.d_init_m);
  measure("z_far_m", settings.z_far_m);
  measure("reference_share", settings.reference_share);
  measure("range_threshold_lx", settings.range_threshold_lx);
  count("face_size_px", settings.face_size_px, UINT32_MAX);
  count("max_shadow_maps", settings.max_shadow_maps, INT64_MAX);
  count("max_shadow_bytes", settings.max_shadow_bytes, INT64_MAX);
}

/// With a place alone, every light is in view.
void read_camera(const Json& json, ChandelierPreviewCamera& camera) {
  constexpr std::string_view known[]{"eye_ws", "forward_ws", "up_ws", "yfov_rad", "znear_m", "size_px"};
  refuse_unknown(json, "camera", known);
  camera = {.struct_bytes = sizeof camera, .up_ws = {0.0f, 1.0f, 0.0f}, .yfov_rad = 1.0f, .znear_m = 0.05f};
  camera.sees_all = !json.contains("forward_ws");
  camera.width_px = 16;
  camera.height_px = 9;
  for (const auto& [key, out] : {std::pair{"eye_ws", camera.eye_ws}, std::pair{"forward_ws", camera.forward_ws},
                                 std::pair{"up_ws", camera.up_ws}})
    if (json.contains(key)) vec3(json[key], inside("camera", key), out);
  for (const auto& [key, out] : {std::pair{"yfov_rad", &camera.yfov_rad}, std::pair{"znear_m", &camera.znear_m}})
    if (json.contains(key)) *out = number(json[key], inside("camera", key));
  if (!json.contains("size_px")) return;
  const Json& size = json["size_px"];
  if (!size.is_array() || size.size() != 2) fail("camera.size_px", "is not two whole numbers", size);
  camera.width_px = static_cast<uint32_t>(whole(size[0], "camera.size_px", 1, UINT32_MAX));
  camera.height_px = static_cast<uint32_t>(whole(size[1], "camera.size_px", 1, UINT32_MAX));
}

nlohmann::ordered_json bill_json(const ChandelierPreviewBill& bill) {
  return {{"lights", bill.lights},
          {"lights_in_view", bill.lights_in_view},
          {"shadowless_in_view", bill.shadowless_in_view},
          {"shadow_maps", bill.shadow_maps},
          {"shadow_views", bill.shadow_views},
          {"shadow_bytes", bill.shadow_bytes},
          {"wanted_shadow_maps", bill.wanted_shadow_maps},
          {"wanted_shadow_bytes", bill.wanted_shadow_bytes},
          {"lights_over_budget", bill.lights_over_budget},
          {"d_init_m", bill.d_init_m},
          {"reference_path", bill.reference_path != 0},
          {"over_budget", bill.over_budget != 0},
          {"misses_budget", bill.misses_budget != 0}};
}

}  // namespace

Request read_request(const nlohmann::json& json) {
  if (!json.is_object()) fail("", "is not an object", json);
  constexpr std::string_view known[]{"lights", "settings", "camera"};
  refuse_unknown(json, "", known);
  Request request;
  read_lights(object_at(json, "lights"), request);
  read_settings(object_at(json, "settings"), request.settings);
  read_camera(object_at(json, "camera"), request.camera);
  return request;
}

nlohmann::ordered_json to_json(const ChandelierPreviewResult& result, uint32_t light_count) {
  nlohmann::ordered_json centers = nlohmann::ordered_json::array(), over_budget = centers, ranges = centers,
                         clusters = centers;
  for (uint32_t light = 0; light < light_count; ++light) {
    const uint32_t center = result.center_of_light[light];
    centers.push_back(center == CHANDELIER_PREVIEW_NONE ? nlohmann::ordered_json() : nlohmann::ordered_json(center));
    ranges.push_back(result.range_of_light_m[light]);
    if (result.over_budget_of_light[light]) over_budget.push_back(light);
  }
  for (const ChandelierPreviewCluster& cluster : std::span(result.clusters, result.cluster_count))
    clusters.push_back({{"center", cluster.center},
                        {"light_count", cluster.light_count},
                        {"d_min_m", cluster.d_min_m},
                        {"range_m", cluster.range_m},
                        {"spread_m", cluster.spread_m}});
  return {{"center_of_light", std::move(centers)},
          {"range_of_light_m", std::move(ranges)},
          {"over_budget", std::move(over_budget)},
          {"clusters", std::move(clusters)},
          {"bill", bill_json(result.bill)}};
}

}  // namespace chandelier::preview
