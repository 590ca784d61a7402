// A window with OpenGL 3.3 and Dear ImGui, and nothing of what it shows.
#pragma once

#include <chrono>
#include <glm/glm.hpp>
#include <optional>
#include <string>

struct GLFWwindow;

namespace foci {

class Window {
 public:
  /// @param size_px  of the window; absent: the whole primary monitor
  /// @throws std::runtime_error where there is no display or no OpenGL 3.3
  Window(const std::string& title, std::optional<glm::ivec2> size_px);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Starts a frame: events, a blank picture. False once the window was closed.
  bool begin(const glm::vec3& background);
  /// Draws the frame's Dear ImGui commands and shows it.
  void end();

  glm::dvec2 size_px() const;
  glm::dvec2 cursor_px() const;
  bool hovered() const;  ///< the mouse is inside
  double time_s() const;

  /// Size of the monitor as it states itself; absent where it does not.
  std::optional<glm::dvec2> monitorSize_m() const;
  glm::ivec2 monitorSize_px() const;

 private:
  GLFWwindow* window_ = nullptr;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// A picture on the graphics card, to be shown by ImGui::Image. Needs a Window.
class Texture {
 public:
  Texture() = default;
  ~Texture();
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;

  /// @param rgb  8 bits a channel, rows from the top, no padding
  void set(const glm::ivec2& size_px, const unsigned char* rgb);
  void* id() const;

 private:
  unsigned id_ = 0;
};

}  // namespace foci
