// A window with OpenGL 3.3 and Dear ImGui; it knows nothing about its content.
#pragma once

#include <chrono>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/gl/device.h"

struct GLFWmonitor;
struct GLFWwindow;

namespace foci {

/// Starts GLFW; with X11 where there is one, since Wayland does not let windows be placed.
/// @return false without a display
bool startGlfw();

class Window {
 public:
  /// @param size_px  of the window; absent: the whole monitor
  /// @param monitor  number; 0 is the primary monitor
  /// @throws InputError for an unknown monitor
  /// @throws std::runtime_error without a display or OpenGL 3.3
  Window(const std::string& title, std::optional<glm::ivec2> size_px, int monitor = 0);
  ~Window();
  Window& operator=(Window&&) = delete;  // nor copied

  /// Another context with OpenGL 4.5, which shares its objects with the window. Null where the
  /// driver has none. The window outlives its use.
  std::unique_ptr<GpuContext> sharedContext();

  /// Waits for input, for `wake`, or for `seconds`. @return false after the window was closed
  bool wait(double seconds);
  /// Ends a `wait`, from any thread.
  static void wake();

  /// Starts a frame: handles events and clears the window. @return false after the window was
  /// closed
  /// @param has_panels  false: no item of Dear ImGui needs mouse and keys, which take time to read
  bool begin(const glm::vec3& background, bool has_panels = true);
  /// Executes the frame's Dear ImGui commands and shows the frame.
  void end();

  /// Keys (numbers of GLFW) pressed since the last call, and characters typed. Of a key that is
  /// held down, only arrows, + - , . and Z repeat.
  std::vector<int> takeKeys();
  std::vector<unsigned> takeTyped();
  /// Whether a key (a letter, an arrow, escape or space; number of GLFW) was pressed in this frame.
  static bool isPressed(int key, bool repeat = false);
  bool isDown(int key) const;           ///< a number of GLFW
  bool isButtonDown(int button) const;  ///< of the mouse; a number of GLFW
  /// Notches of the wheel forwards since the last call.
  double takeWheel();
  /// Files dropped on the window since the last call.
  std::vector<std::filesystem::path> takeDropped();

  glm::dvec2 size_px() const { return size_px_; }
  void resize(const glm::ivec2& size_px);
  /// Between the whole monitor and a window.
  void toggleFullScreen();
  glm::ivec2 frameBufferSize_px() const { return frame_buffer_px_; }
  glm::dvec2 cursor_px() const { return cursor_px_; }
  bool hovered() const { return hovered_; }  ///< true while the mouse is inside
  /// Refresh rate that the monitor states; 60 if it states none.
  double refresh_Hz() const;
  double time_s() const;

  /// Size that the monitor states; absent if it states none.
  std::optional<glm::dvec2> monitorSize_m() const;
  glm::ivec2 monitorSize_px() const;

 private:
  void listen();

  GLFWwindow* window_ = nullptr;
  std::vector<GLFWwindow*> hidden_;  // of the shared contexts
  std::vector<int> keys_;
  std::vector<unsigned> typed_;
  std::vector<std::filesystem::path> dropped_;
  bool repeats_ = false;  // the latest key is held down
  double wheel_ = 0.0;
  // As the latest events say. To ask the X server takes a tenth of a millisecond each time.
  glm::dvec2 size_px_{0.0}, cursor_px_{0.0};
  glm::ivec2 frame_buffer_px_{0};
  bool hovered_ = false;
  glm::ivec4 windowed_px_{60, 60, 1280, 720};  // place and size before the full screen
  GLFWmonitor* monitor_ = nullptr;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// A part of the frame buffer, px. The corner is the upper left one.
struct Area {
  glm::ivec2 corner_px{0}, size_px{0};

  /// The largest area of the shape of `shape_px`, in the middle.
  static Area inside(const glm::ivec2& frame_buffer_px, const glm::ivec2& shape_px);
};

/// An image on the graphics card, for ImGui::Image. Needs a Window.
class Texture {
 public:
  Texture() = default;
  ~Texture();
  Texture& operator=(Texture&&) = delete;  // nor copied

  /// @param rgb  8 bits a channel, rows from the top, no padding
  void set(const glm::ivec2& size_px, const unsigned char* rgb);
  void* id() const;

  /// Fills an area with the image: faster than Dear ImGui, which blends.
  /// @param views   across the image, of which the window shows the first
  void fill(const Area& area, int views = 1);
  /// The same with another texture, 8 bits a channel, rows from the top.
  void fillFrom(unsigned texture, const glm::ivec2& texture_px, const Area& area, int views = 1);

 private:
  unsigned id_ = 0, frame_buffer_ = 0;
  glm::ivec2 size_px_{0, 0};
  std::vector<unsigned char> bgra_;  // a member to reuse its memory
};

}  // namespace foci
