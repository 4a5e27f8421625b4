// SPDX-License-Identifier: Apache-2.0
// The keys of the window: window.cpp reads them, --help and this folder's README list them.
#pragma once

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <array>
#include <string_view>

namespace chandelier::player {

enum class Does { forward, left, back, right, down, up, faster, look, keep_looking, speed, headlight, quit };

struct WindowKey {
  Does does;
  int code;  // GLFW's, of a key; of a mouse button for look; unused for the wheel
  std::string_view name;
  std::string_view meaning;
};

inline constexpr std::array window_keys{
    WindowKey{Does::forward, GLFW_KEY_W, "W", "fly forward"},
    WindowKey{Does::left, GLFW_KEY_A, "A", "fly left"},
    WindowKey{Does::back, GLFW_KEY_S, "S", "fly back"},
    WindowKey{Does::right, GLFW_KEY_D, "D", "fly right"},
    WindowKey{Does::down, GLFW_KEY_Q, "Q", "fly down"},
    WindowKey{Does::up, GLFW_KEY_E, "E", "fly up"},
    WindowKey{Does::faster, GLFW_KEY_LEFT_SHIFT, "Shift", "held: four times as fast"},
    WindowKey{Does::look, GLFW_MOUSE_BUTTON_RIGHT, "Right mouse button", "held: look around"},
    WindowKey{Does::keep_looking, GLFW_KEY_TAB, "Tab", "look around without the button; again: stop"},
    WindowKey{Does::speed, 0, "Mouse wheel", "fly faster or slower"},
    WindowKey{Does::headlight, GLFW_KEY_H, "H", "headlight at the camera on or off"},
    WindowKey{Does::quit, GLFW_KEY_ESCAPE, "Esc", "quit"},
};

constexpr int key_code(Does does) {
  for (const WindowKey& key : window_keys)
    if (key.does == does) return key.code;
  return GLFW_KEY_UNKNOWN;
}

}  // namespace chandelier::player
