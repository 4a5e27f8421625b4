// SPDX-License-Identifier: Apache-2.0
// A plain window with a fly camera. It draws only when something changed, so an untouched window costs nothing.
#include "player/window.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "gpu/frames.h"
#include "player/darkness.h"
#include "player/swapchain.h"
#include "player/window_keys.h"

namespace chandelier::player {
namespace {

constexpr float crossing_s = 10.0f;  // from one end of the scene to the other
constexpr float slowest_m_per_s = 0.02f;
constexpr float fastest_m_per_s = 500.0f;
constexpr float fast_factor = 4.0f;  // with Shift
constexpr float turn_rad_per_px = 0.003f;
constexpr float longest_step_s = 0.25f;       // a slow device must not throw the camera through a wall
constexpr float first_step_s = 1.0f / 60.0f;  // after a rest, during which the camera did not move
constexpr double nap_s = 0.25;                // longest wait for an event: signals and new packs raise none

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
  return std::clamp(glm::distance(info.bounds_min_ws, info.bounds_max_ws) / crossing_s, slowest_m_per_s,
                    fastest_m_per_s);
}

// Where the CPU draws, a second frame on its way would only be late.
uint32_t frames_in_flight(const gpu::Device& device) {
  return device.is_software ? 1 : 2;
}

std::string title(const LiveScene& live, const FrameStats& stats) {
  const Options& options = live.scene().options;
  return fmt::format("{}{}: {}, {:.1f} ms, {} lights, {} shadow maps", options.pack.filename().string(),
                     live.is_older() ? " (an older one: the file cannot be read now)" : "",
                     options.recipes.front().preset, stats.frame_ms, stats.lights, stats.shadow_maps);
}

}  // namespace

struct Window::Impl {
  GLFWwindow* window = nullptr;
  float speed_m_per_s = 1.0f;
  bool looking = false;
  bool captured = false;
  bool is_covered = false;  // something lay over what was shown
  bool headlight_was_pressed = false;
  double cursor_x = 0.0;
  double cursor_y = 0.0;

  ~Impl() {
    if (window != nullptr) glfwDestroyWindow(window);
    glfwTerminate();
  }

  static Impl& of(GLFWwindow* window) { return *static_cast<Impl*>(glfwGetWindowUserPointer(window)); }
  static void on_key(GLFWwindow* window, int key, int, int action, int) {
    if (action != GLFW_PRESS) return;
    if (key == key_code(Does::quit)) glfwSetWindowShouldClose(window, GLFW_TRUE);
    if (key == key_code(Does::keep_looking)) of(window).captured = !of(window).captured;
    if (key == key_code(Does::headlight)) of(window).headlight_was_pressed = true;
  }
  static void on_scroll(GLFWwindow* window, double, double y) {
    float& speed = of(window).speed_m_per_s;
    speed = std::clamp(speed * (y > 0.0 ? 1.25f : 0.8f), slowest_m_per_s, fastest_m_per_s);
  }
  static void on_refresh(GLFWwindow* window) { of(window).is_covered = true; }

  bool is_held(Does does) const { return glfwGetKey(window, key_code(does)) == GLFW_PRESS; }
  bool is_minimised() const {
    const VkExtent2D size = framebuffer_size(window);
    return size.width == 0 || size.height == 0 || glfwGetWindowAttrib(window, GLFW_ICONIFIED) == GLFW_TRUE;
  }

  void look(Camera& camera) {
    const bool wanted = captured || glfwGetMouseButton(window, key_code(Does::look)) == GLFW_PRESS;
    double x = 0.0;
    double y = 0.0;
    if (wanted != looking) {
      glfwSetInputMode(window, GLFW_CURSOR, wanted ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
      glfwGetCursorPos(window, &cursor_x, &cursor_y);
      looking = wanted;
    }
    glfwGetCursorPos(window, &x, &y);
    if (looking && (x != cursor_x || y != cursor_y))
      turn(camera, static_cast<float>(x - cursor_x) * turn_rad_per_px,
           static_cast<float>(cursor_y - y) * turn_rad_per_px);
    cursor_x = x;
    cursor_y = y;
  }

  void fly(Camera& camera, float seconds) {
    const auto axis = [this](Does minus, Does plus) {
      return static_cast<float>(is_held(plus)) - static_cast<float>(is_held(minus));
    };
    const bool fast = is_held(Does::faster) || glfwGetKey(window, GLFW_KEY_RIGHT_SHIFT) == GLFW_PRESS;
    const float step_m = speed_m_per_s * (fast ? fast_factor : 1.0f) * std::min(seconds, longest_step_s);
    move(camera, step_m * glm::vec3(axis(Does::left, Does::right), axis(Does::down, Does::up),
                                    axis(Does::back, Does::forward)));
  }

  void steer(LiveScene& live, float seconds) {
    look(live.settings.camera);
    fly(live.settings.camera, seconds);
    const VkExtent2D size = framebuffer_size(window);
    live.settings.width = size.width;
    live.settings.height = size.height;
    if (std::exchange(headlight_was_pressed, false)) live.toggle_headlight();
  }
};

// The picture on the screen: drawn again if something changed. The next frame is recorded while the device still works
// on the last.
class Window::Screen {
 public:
  Screen(Impl& of, LiveScene& live, const gpu::Device& device, VkSurfaceKHR surface)
      : impl_(of),
        live_(live),
        ring_(device, frames_in_flight(device)),
        swapchain_(device, surface, frames_in_flight(device)) {}

  /// Returns true if it showed a picture. `draws_anyway`: draw even if nothing changed.
  bool update(bool draws_anyway) {
    const bool is_replaced = live_.follow();
    if (is_replaced) {
      last_slot_.reset();
      drawn_ = {};
    }
    if (is_replaced || draws_anyway || live_.renderer().has_new_selection() || !(of(live_.settings) == drawn_))
      show(true);
    else if (impl_.is_covered)
      show(false);
    else {
      take_stats();
      return false;
    }
    return true;
  }

  uint32_t frames_shown() const { return frames_shown_; }
  /// One line of what was drawn, for the end.
  std::string summary(const gpu::Device& device) {
    ring_.wait_for_all();
    take_stats();
    const Options& options = live_.scene().options;
    return fmt::format("{}: {} frames drawn, the last {}x{}, {}, {} lights, {} shadow maps, {:.1f} ms on {}",
                       options.pack.string(), frames_drawn_, drawn_.width, drawn_.height,
                       options.recipes.front().preset, stats_.lights, stats_.shadow_maps, stats_.frame_ms, device.name);
  }

 private:
  // What one can change of the settings.
  struct View {
    Camera camera;
    uint32_t width = 0;
    uint32_t height = 0;
    float headlight = 0.0f;
    bool operator==(const View&) const = default;
  };
  static View of(const RenderSettings& settings) {
    return {settings.camera, settings.width, settings.height, settings.headlight};
  }

  // Draws the picture, or reuses the last one, and shows it.
  void show(bool draws) {
    const uint32_t slot = ring_.next();
    const auto image = swapchain_.acquire(slot, framebuffer_size(impl_.window));
    impl_.is_covered = !image;
    if (!image) return;
    const bool by_rays = live_.settings.recipe.filter == Filter::rays;
    if (draws && by_rays) finish_drawing(live_.renderer().draw(live_.settings));
    const gpu::Commands cmd = ring_.begin(slot);
    const Target target{image->image, image->size};
    if (draws && !by_rays) {
      last_slot_ = slot;
      finish_drawing(live_.renderer().record(cmd, slot, live_.settings, target));
    } else {
      live_.renderer().record_again(cmd, target);
    }
    ring_.submit(slot, image->acquired, image->drawn);
    impl_.is_covered = !swapchain_.present(*image);
    frames_shown_ += !impl_.is_covered;
    if (draws) judge_first_picture();
  }

  void finish_drawing(const FrameStats& known) {
    const double last_ms = known.frame_ms > 0.0 ? known.frame_ms : stats_.frame_ms;
    stats_ = known;
    stats_.frame_ms = last_ms;
    live_.settings.previous_centers = known.centers;
    drawn_ = of(live_.settings);
    ++frames_drawn_;
    glfwSetWindowTitle(impl_.window, title(live_, stats_).c_str());
  }

  // The last frame's time, once the device has finished it.
  void take_stats() {
    if (!last_slot_ || !ring_.is_finished(*last_slot_)) return;
    stats_ = live_.renderer().stats(*last_slot_);
    last_slot_.reset();
    glfwSetWindowTitle(impl_.window, title(live_, stats_).c_str());
  }

  void judge_first_picture() {
    const Scene& scene = live_.scene();
    if (std::exchange(judged_, scene.stamp) != scene.stamp)
      warn_of_black(scene.options, scene.pack.view(), live_.renderer().read_back());
  }

  Impl& impl_;
  LiveScene& live_;
  gpu::FrameRing ring_;
  Swapchain swapchain_;
  View drawn_;
  FrameStats stats_;
  std::optional<uint32_t> last_slot_;  // of the last frame recorded, while its time is not known
  FileStamp judged_;                   // of the last pack whose first picture was looked at
  uint32_t frames_drawn_ = 0;
  uint32_t frames_shown_ = 0;
};

Window::Window(const Options& options) : impl_(std::make_unique<Impl>()) {
  glfwSetErrorCallback([](int, const char* description) { glfw_error = description; });
  if (glfwInit() != GLFW_TRUE)
    throw std::runtime_error(fmt::format("no display: use --output FILE.png ({})", glfw_error));
  if (glfwVulkanSupported() != GLFW_TRUE) {
    gpu::list_devices();  // throws where there is no loader or driver, and says what brings one
    throw std::runtime_error(fmt::format("Vulkan cannot show pictures here: use --output FILE.png ({})", glfw_error));
  }
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  impl_->window = glfwCreateWindow(static_cast<int>(options.width), static_cast<int>(options.height), "chandelier-play",
                                   nullptr, nullptr);
  if (impl_->window == nullptr)
    throw std::runtime_error(fmt::format("no window: use --output FILE.png ({})", glfw_error));
  glfwSetWindowUserPointer(impl_->window, impl_.get());
  glfwSetInputMode(impl_->window, GLFW_STICKY_KEYS, GLFW_TRUE);  // a press shorter than a frame still counts
  glfwSetKeyCallback(impl_->window, &Impl::on_key);
  glfwSetScrollCallback(impl_->window, &Impl::on_scroll);
  glfwSetWindowRefreshCallback(impl_->window, &Impl::on_refresh);
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
  Screen screen(*impl_, live, device, surface);
  impl_->speed_m_per_s = speed_through(live.scene().pack);
  std::signal(SIGINT, [](int) { asked_to_end = 1; });
  std::signal(SIGTERM, [](int) { asked_to_end = 1; });

  const std::optional<uint32_t> most_frames = live.scene().options.frames;
  auto before = std::chrono::steady_clock::now();
  bool is_idle = false;
  while (!glfwWindowShouldClose(window) && asked_to_end == 0 &&
         screen.frames_shown() < most_frames.value_or(UINT32_MAX)) {
    if (is_idle)
      glfwWaitEventsTimeout(nap_s);
    else
      glfwPollEvents();
    const auto now = std::chrono::steady_clock::now();
    const float seconds = is_idle ? first_step_s : std::chrono::duration<float>(now - before).count();
    before = now;
    is_idle = impl_->is_minimised();
    if (is_idle) continue;
    impl_->steer(live, seconds);
    is_idle = !screen.update(most_frames.has_value());
  }
  fmt::print(stderr, "{}\n", screen.summary(device));
}

}  // namespace chandelier::player
