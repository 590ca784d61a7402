// A window with OpenGL 3.3 and Dear ImGui, and nothing of what it shows.
#pragma once

#include <chrono>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

struct GLFWmonitor;
struct GLFWwindow;

namespace foci {

class Window {
 public:
  /// @param size_px  of the window; absent: the whole monitor
  /// @param monitor  counted from 0, the primary one
  /// @throws InputError where there is no such monitor
  /// @throws std::runtime_error where there is no display or no OpenGL 3.3
  Window(const std::string& title, std::optional<glm::ivec2> size_px, int monitor = 0);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Waits for input, for `wake` or until the time is over. False once the window was closed.
  bool wait(double seconds);
  /// Ends a `wait`, from any thread.
  static void wake();

  /// Starts a frame: events, a blank image. False once the window was closed.
  bool begin(const glm::vec3& background);
  /// Draws the frame's Dear ImGui commands and shows it.
  void end();

  /// Keys (GLFW's numbers) that went down or repeated since the last call, and what was typed.
  std::vector<int> takeKeys();
  std::vector<unsigned> takeTyped();
  bool leftButton() const;   ///< of the mouse is down
  bool rightButton() const;  ///< of the mouse is down

  glm::dvec2 size_px() const;
  glm::ivec2 frameBufferSize_px() const;
  glm::dvec2 cursor_px() const;
  bool hovered() const;  ///< the mouse is inside
  /// Of the window's monitor, as it states itself; 60 where it does not.
  double refresh_Hz() const;
  double time_s() const;

  /// Size of the monitor as it states itself; absent where it does not.
  std::optional<glm::dvec2> monitorSize_m() const;
  glm::ivec2 monitorSize_px() const;

 private:
  void listen();

  GLFWwindow* window_ = nullptr;
  std::vector<int> keys_;
  std::vector<unsigned> typed_;
  GLFWmonitor* monitor_ = nullptr;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// An image on the graphics card, to be shown by ImGui::Image. Needs a Window.
class Texture {
 public:
  Texture() = default;
  ~Texture();
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  /// @param rgb  8 bits a channel, rows from the top, no padding
  void set(const glm::ivec2& size_px, const unsigned char* rgb);
  void* id() const;

  /// Fills the window with it: quicker than through Dear ImGui, which blends.
  /// @param size_px  of the window's frame buffer
  void fill(const glm::ivec2& size_px) const;

 private:
  unsigned id_ = 0, frame_buffer_ = 0;
  glm::ivec2 size_px_{0, 0};
  std::vector<unsigned char> bgra_;  // kept for its memory
};

}  // namespace foci
