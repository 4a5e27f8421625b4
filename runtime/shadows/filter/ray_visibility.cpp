// SPDX-License-Identifier: Apache-2.0
#include "shadows/filter/ray_visibility.h"

#include <volk.h>

#include <cstring>

#include "octahedral.h"
#include "shadows/deliver/visibility_textures.h"

namespace chandelier {

gpu::Buffer make_surface_readback(const gpu::Device& device, uint32_t width, uint32_t height) {
  return gpu::make_buffer(device, VkDeviceSize{20} * width * height, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                          gpu::Memory::readback);
}

void record_read_surfaces(gpu::Commands cmd, const Targets& targets, const gpu::Buffer& readback) {
  VkBufferImageCopy copy{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                         .imageExtent = {targets.width, targets.height, 1}};
  gpu::image_barrier(cmd, targets.surface, use::sampled, use::copied);
  cmd->vkCmdCopyImageToBuffer(cmd, targets.surface.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, readback.handle, 1,
                              &copy);
  gpu::image_barrier(cmd, targets.surface, use::copied, use::sampled);
  copy.imageSubresource.aspectMask = targets.depth.aspect;
  copy.bufferOffset = VkDeviceSize{16} * targets.width * targets.height;
  gpu::image_barrier(cmd, targets.depth, use::sampled, use::copied);
  cmd->vkCmdCopyImageToBuffer(cmd, targets.depth.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, readback.handle, 1,
                              &copy);
  gpu::image_barrier(cmd, targets.depth, use::copied, use::sampled);
  gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                      VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}

// As shading/eye_position.glsl and shading/surface.glsl.
std::vector<SurfacePoint> surface_points(const gpu::Buffer& readback, const frame::ViewConstants& view) {
  const auto width = static_cast<uint32_t>(view.size_px.x);
  const auto height = static_cast<uint32_t>(view.size_px.y);
  const glm::mat4 eye_from_clip(view.eye_from_clip[0], view.eye_from_clip[1], view.eye_from_clip[2],
                                view.eye_from_clip[3]);
  const size_t pixels = size_t{width} * height;
  std::vector<SurfacePoint> points(pixels, {glm::vec3(0.0f), glm::vec3(0.0f)});
  for (size_t i = 0; i < pixels; ++i) {
    float depth = 0.0f;
    uint32_t normal_bits = 0;
    std::memcpy(&depth, readback.mapped + 16 * pixels + 4 * i, sizeof depth);
    std::memcpy(&normal_bits, readback.mapped + 16 * i + 4, sizeof normal_bits);
    if (depth == 0.0f) continue;
    const glm::vec2 pixel(static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f);
    const glm::vec4 p = eye_from_clip * glm::vec4(pixel / view.size_px * 2.0f - 1.0f, depth, 1.0f);
    points[i] = {glm::vec3(p) / p.w, pack::decode_normal(normal_bits)};
  }
  return points;
}

namespace {

// A map's light at some points.
void ask(const AskedLights& lights, const frame::ShadowMap& map, std::span<const SurfacePoint> points,
         const VisibilitySource& source, std::span<uint8_t> bytes) {
  const bool directional = map.projection == frame::Projection::cascade;
  const float radius_m = directional ? map.filter_radius_m / lights.z_far_m : map.filter_radius_m;
  source({lights.list.lights[map.first_light], map.near_m, radius_m, lights.eye_ws, points, bytes});
}

}  // namespace

void fill_visibility(const AskedLights& lights, const MapGroup& group, std::span<const SurfacePoint> points,
                     uint32_t width, const VisibilitySource& source, std::span<uint8_t> bytes) {
  std::vector<SurfacePoint> in_rect;
  for (uint32_t m = group.first_map; m < group.first_map + group.map_count; ++m) {
    const frame::ShadowMap& map = lights.list.maps[m];
    in_rect.clear();
    for (uint32_t y = map.rect_y; y < map.rect_y + map.rect_height; ++y) {
      const auto row = points.subspan(size_t{y} * width + map.rect_x, map.rect_width);
      in_rect.insert(in_rect.end(), row.begin(), row.end());
    }
    ask(lights, map, in_rect, source, bytes.subspan(map.first_visibility, visibility_bytes(map)));
  }
}

std::vector<SurfacePoint> read_edge_points(const gpu::Device& device, const Edges& edges, const gpu::Buffer& view) {
  const gpu::Buffer counters =
      gpu::make_buffer(device, sizeof(frame::EdgeCounters), VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback);
  gpu::run_once(device, [&](gpu::Commands cmd) {
    gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                        VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT);
    const VkBufferCopy copy{.size = sizeof(frame::EdgeCounters)};
    cmd->vkCmdCopyBuffer(cmd, edges.lists.counters.handle, counters.handle, 1, &copy);
    gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                        VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
  });
  frame::EdgeCounters found;
  std::memcpy(&found, counters.mapped, sizeof found);
  if (found.surfaces == 0) return {};
  if (uint64_t{found.surfaces} * sizeof(frame::EdgePoint) > device.limits.maxStorageBufferRange)
    throw gpu::Error("the surfaces of edge pixels are too many for rays on this device (" +
                     std::to_string(found.surfaces) + "); use fewer samples or a smaller picture");
  const gpu::Buffer points = gpu::make_buffer(device, found.surfaces * sizeof(frame::EdgePoint),
                                              VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::readback);
  gpu::run_once(device, [&](gpu::Commands cmd) {
    record_edge_points(cmd, edges, view, points);
    gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                        VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
  });
  std::vector<SurfacePoint> read;
  read.reserve(found.surfaces);
  for (size_t i = 0; i < found.surfaces; ++i) {
    frame::EdgePoint point;
    std::memcpy(&point, points.mapped + i * sizeof point, sizeof point);
    read.push_back({point.position, point.normal_ws});
  }
  return read;
}

void fill_edge_visibility(const AskedLights& lights, const MapGroup& group, std::span<const SurfacePoint> points,
                          const VisibilitySource& source, std::span<uint8_t> bytes) {
  for (uint32_t m = 0; m < group.map_count; ++m)
    ask(lights, lights.list.maps[group.first_map + m], points, source, bytes.subspan(m * points.size(), points.size()));
}

}  // namespace chandelier
