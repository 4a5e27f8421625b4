// SPDX-License-Identifier: Apache-2.0
// A compiled shader and what it expects to be given. Headers shaders/NAME_STAGE.h hold one each, read from its SPIR-V.
#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace chandelier::gpu {

struct Binding {
  uint32_t set;
  uint32_t number;
  VkDescriptorType type;
  std::string_view name;  // in GLSL: of the block where it has no instance, else of the variable
  bool is_used = true;    // by the shader's code; else it is only declared, and need not be bound
};

/// A specialization constant by its constant_id, or a vertex input by its location, and its name in GLSL.
struct Named {
  uint32_t number;
  std::string_view name;
};

struct Shader {
  std::string_view name;  // "cull_none_comp"
  std::span<const uint32_t> words;
  std::span<const Binding> bindings;   // in order of set and number
  uint32_t push_bytes;                 // of push constants
  std::array<uint32_t, 3> local_size;  // threads of a work group; 0 but for compute
  std::span<const Named> constants;    // specialization constants
  std::span<const Named> inputs;       // of a vertex shader
};

}  // namespace chandelier::gpu
