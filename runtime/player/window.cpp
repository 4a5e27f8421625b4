// SPDX-License-Identifier: Apache-2.0
// A plain window with a fly camera. The keys are listed in this folder's README.
#include "player/window.h"

#include <volk.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <stdexcept>
#include <string>

#include "player/swapchain.h"

namespace chandelier::player {
namespace {

constexpr float kCrossing_s = 10.0f;  // from one end of the scene to the other
constexpr float kSlowest_m_per_s = 0.02f;
constexpr float kFastest_m_per_s = 500.0f;
constexpr float kFast = 4.0f;  // with Shift
constexpr float kTurn_rad_per_px = 0.003f;
constexpr float kLongestStep_s = 0.25f;  // a slow device must not throw the camera through a wall

volatile std::sig_atomic_t asked_to_end = 0;
std::string glfw_error;  // the last one's description

VkExtent2D framebuffer_size(GLFWwindow* window) {
  int width = 0;
  int height = 0;
  glfwGetFramebufferSize(window, &width, &height);
  return {static_cast<uint32_t>(std::max(width, 0)), static_cast<uint32_t>(std::max(height, 0))};
}

float speed_through(const pack::File& pack) {
  const pack::BakeInfo& info = *pack.view().bake_info;
  return std::clamp(glm::distance(info.bounds_min_ws, info.bounds_max_ws) / kCrossing_s, kSlowest_m_per_s,
                    kFastest_m_per_s);
}

std::string title(const LiveScene& live, const FrameStats& stats) {
  const Options& options = live.scene().options;
  return fmt::format("{}{}: {}, {:.1f} ms, {} lights, {} shadow maps", options.pack.filename().string(),
                     live.is_older() ? " (an older one: it cannot be read now)" : "", options.recipes.front().preset,
                     stats.frame_ms, stats.lights, stats.shadow_maps);
}

}  // namespace

struct Window::Impl {
  GLFWwindow* window = nullptr;
  float speed_m_per_s = 1.0f;
  bool looking = false;
  bool captured = false;
  double cursor_x = 0.0;
  double cursor_y = 0.0;

  ~Impl() {
    if (window != nullptr) glfwDestroyWindow(window);
    glfwTerminate();
  }

  static Impl& of(GLFWwindow* window) { return *static_cast<Impl*>(glfwGetWindowUserPointer(window)); }
  static void on_key(GLFWwindow* window, int key, int, int action, int) {
    if (action != GLFW_PRESS) return;
    if (key == GLFW_KEY_ESCAPE) glfwSetWindowShouldClose(window, GLFW_TRUE);
    if (key == GLFW_KEY_TAB) of(window).captured = !of(window).captured;
  }
  static void on_scroll(GLFWwindow* window, double, double y) {
    float& speed = of(window).speed_m_per_s;
    speed = std::clamp(speed * (y > 0.0 ? 1.25f : 0.8f), kSlowest_m_per_s, kFastest_m_per_s);
  }

  void look(Camera& camera) {
    const bool wanted = captured || glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS;
    double x = 0.0;
    double y = 0.0;
    if (wanted != looking) {
      glfwSetInputMode(window, GLFW_CURSOR, wanted ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
      glfwGetCursorPos(window, &cursor_x, &cursor_y);
      looking = wanted;
    }
    glfwGetCursorPos(window, &x, &y);
    if (looking && (x != cursor_x || y != cursor_y))
      turn(camera, static_cast<float>(x - cursor_x) * kTurn_rad_per_px,
           static_cast<float>(cursor_y - y) * kTurn_rad_per_px);
    cursor_x = x;
    cursor_y = y;
  }

  void fly(Camera& camera, float seconds) {
    const auto axis = [this](int minus, int plus) {
      return static_cast<float>(glfwGetKey(window, plus) == GLFW_PRESS) -
             static_cast<float>(glfwGetKey(window, minus) == GLFW_PRESS);
    };
    const bool fast =
        glfwGetKey(window, GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS || glfwGetKey(window, GLFW_KEY_RIGHT_SHIFT) == GLFW_PRESS;
    const float step_m = speed_m_per_s * (fast ? kFast : 1.0f) * std::min(seconds, kLongestStep_s);
    move(camera,
         step_m * glm::vec3(axis(GLFW_KEY_A, GLFW_KEY_D), axis(GLFW_KEY_Q, GLFW_KEY_E), axis(GLFW_KEY_S, GLFW_KEY_W)));
  }
};

Window::Window(const Options& options) : impl_(std::make_unique<Impl>()) {
  glfwSetErrorCallback([](int, const char* description) { glfw_error = description; });
  if (glfwInit() != GLFW_TRUE)
    throw std::runtime_error(fmt::format("no display: use --output FILE.png ({})", glfw_error));
  if (glfwVulkanSupported() != GLFW_TRUE)
    throw std::runtime_error(fmt::format("Vulkan cannot show pictures here: use --output FILE.png ({})", glfw_error));
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  impl_->window = glfwCreateWindow(static_cast<int>(options.width), static_cast<int>(options.height), "chandelier-play",
                                   nullptr, nullptr);
  if (impl_->window == nullptr)
    throw std::runtime_error(fmt::format("no window: use --output FILE.png ({})", glfw_error));
  glfwSetWindowUserPointer(impl_->window, impl_.get());
  glfwSetInputMode(impl_->window, GLFW_STICKY_KEYS, GLFW_TRUE);  // a press shorter than a frame still counts
  glfwSetKeyCallback(impl_->window, &Impl::on_key);
  glfwSetScrollCallback(impl_->window, &Impl::on_scroll);
}

Window::~Window() = default;

std::vector<const char*> Window::instance_extensions() const {
  uint32_t count = 0;
  const char** const names = glfwGetRequiredInstanceExtensions(&count);
  return {names, names + count};
}

void Window::run(LiveScene& live, const gpu::Device& device) {
  GLFWwindow* const window = impl_->window;
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  gpu::check(glfwCreateWindowSurface(device.instance, window, nullptr, &surface), "glfwCreateWindowSurface");
  Swapchain swapchain(device, surface);
  impl_->speed_m_per_s = speed_through(live.scene().pack);
  std::signal(SIGINT, [](int) { asked_to_end = 1; });
  std::signal(SIGTERM, [](int) { asked_to_end = 1; });

  const uint32_t most_frames = live.scene().options.frames.value_or(UINT32_MAX);
  auto before = std::chrono::steady_clock::now();
  uint32_t frames = 0;
  while (!glfwWindowShouldClose(window) && asked_to_end == 0 && frames < most_frames) {
    glfwPollEvents();
    const VkExtent2D size = framebuffer_size(window);
    if (size.width == 0 || size.height == 0) {
      glfwWaitEventsTimeout(0.1);
      continue;
    }
    const auto now = std::chrono::steady_clock::now();
    impl_->look(live.settings.camera);
    impl_->fly(live.settings.camera, std::chrono::duration<float>(now - before).count());
    before = now;
    live.settings.width = size.width;
    live.settings.height = size.height;
    live.follow();
    const FrameStats stats = live.renderer().draw(live.settings);
    live.settings.previous_centers = stats.centers;
    if (swapchain.show(live.renderer().shown_image(), size, framebuffer_size(window))) ++frames;
    glfwSetWindowTitle(window, title(live, stats).c_str());
  }
}

}  // namespace chandelier::player
