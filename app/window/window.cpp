#include "app/window/window.h"

// Declares the functions beyond OpenGL 1.1, which the library has.
#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
//
#include <GL/glx.h>
#include <GLFW/glfw3.h>
// X11 gives these words away.
#undef None
#undef Bool
#undef Always
#undef Status
#undef Success
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cstdint>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "base/input_error.h"

// glfw3native.h has them, but wants headers of Xrandr too.
extern "C" {
Display* glfwGetX11Display();
GLXContext glfwGetGLXContext(GLFWwindow* window);
GLXWindow glfwGetGLXWindow(GLFWwindow* window);
}

namespace foci {
namespace {

constexpr float kFont_px = 20.0f;
// A switch would flip while its key is held down; a step repeats.
constexpr std::array kRepeating{
    GLFW_KEY_LEFT,  GLFW_KEY_RIGHT,  GLFW_KEY_UP,    GLFW_KEY_DOWN,
    GLFW_KEY_EQUAL, GLFW_KEY_KP_ADD, GLFW_KEY_MINUS, GLFW_KEY_KP_SUBTRACT,
    GLFW_KEY_COMMA, GLFW_KEY_PERIOD, GLFW_KEY_Z};

/// The context of a window that stays hidden. Any thread may make it current.
class HiddenContext final : public GpuContext {
 public:
  explicit HiddenContext(GLFWwindow* window) : window_(window) {}
  ~HiddenContext() override {
    if (glfwGetCurrentContext() == window_) glfwMakeContextCurrent(before_);
  }
  bool makeCurrent() override {
    before_ = glfwGetCurrentContext();
    glfwMakeContextCurrent(window_);
    return glfwGetCurrentContext() == window_;
  }
  void release() override { glfwMakeContextCurrent(before_); }
  NativeGl native() const override;

 private:
  GLFWwindow* window_;
  GLFWwindow* before_ = nullptr;
};

/// GLFW does not tell the configuration, but the context does.
NativeGl HiddenContext::native() const {
  Display* const display = glfwGetX11Display();
  if (!display) return {};
  const GLXContext context = glfwGetGLXContext(window_);
  int id = 0, count = 0, visual = 0;
  glXQueryContext(display, context, GLX_FBCONFIG_ID, &id);
  const int wanted[] = {GLX_FBCONFIG_ID, id, 0};
  GLXFBConfig* const all = glXChooseFBConfig(display, DefaultScreen(display), wanted, &count);
  const GLXFBConfig config = count > 0 ? all[0] : nullptr;
  if (all) XFree(all);
  if (config) glXGetFBConfigAttrib(display, config, GLX_VISUAL_ID, &visual);
  return {.display = display,
          .config = config,
          .context = context,
          .drawable = glfwGetGLXWindow(window_),
          .visual = static_cast<unsigned>(visual)};
}

#if IMGUI_VERSION_NUM >= 18700
ImGuiKey keyOf(int key) {
  if (key == GLFW_KEY_ESCAPE) return ImGuiKey_Escape;
  if (key == GLFW_KEY_SPACE) return ImGuiKey_Space;
  if (key == GLFW_KEY_LEFT) return ImGuiKey_LeftArrow;
  if (key == GLFW_KEY_RIGHT) return ImGuiKey_RightArrow;
  return static_cast<ImGuiKey>(ImGuiKey_A + (key - GLFW_KEY_A));
}
#else
int keyOf(int key) { return key; }
#endif

constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

}  // namespace

bool startGlfw() {
#ifdef GLFW_PLATFORM
  if (std::getenv("DISPLAY") != nullptr) glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
#endif
  return glfwInit() == GLFW_TRUE;
}

Window::Window(const std::string& title, std::optional<glm::ivec2> size_px, int monitor) {
  if (!startGlfw()) throw std::runtime_error("no display for a window");
  int monitors = 0;
  GLFWmonitor** all = glfwGetMonitors(&monitors);
  if (monitor < 0 || monitor >= std::max(monitors, 1)) {
    glfwTerminate();
    throw InputError("--monitor " + std::to_string(monitor),
                     "expected 0 to " + std::to_string(std::max(monitors, 1) - 1));
  }
  monitor_ = monitors > 0 ? all[monitor] : nullptr;
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  if (size_px || !monitor_) {
    const glm::ivec2 size = size_px.value_or(glm::ivec2(1280, 720));
    window_ = glfwCreateWindow(size.x, size.y, title.c_str(), nullptr, nullptr);
    if (window_ && monitor > 0) {
      int x = 0, y = 0;
      glfwGetMonitorPos(monitor_, &x, &y);
      glfwSetWindowPos(window_, x + 40, y + 40);
    }
  } else {
    const GLFWvidmode* mode = glfwGetVideoMode(monitor_);
    window_ = glfwCreateWindow(mode->width, mode->height, title.c_str(), monitor_, nullptr);
  }
  if (!window_) {
    glfwTerminate();
    throw std::runtime_error("no OpenGL 3.3 for a window");
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  float scale = 1.0f;  // of the screen, as its user has set it
  glfwGetWindowContentScale(window_, &scale, nullptr);
  if (!std::filesystem::exists(kFont) || !io.Fonts->AddFontFromFileTTF(kFont, scale * kFont_px)) {
    io.Fonts->AddFontDefault();
    io.FontGlobalScale = 1.5f * scale;
  }
  ImGui::StyleColorsLight();
  ImGui::GetStyle().ScaleAllSizes(scale);
  listen();
  ImGui_ImplGlfw_InitForOpenGL(window_, true);  // ImGui's listeners call ours too
  ImGui_ImplOpenGL3_Init("#version 330");
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  for (GLFWwindow* const hidden : hidden_) glfwDestroyWindow(hidden);
  glfwDestroyWindow(window_);
  glfwTerminate();
}

std::unique_ptr<GpuContext> Window::sharedContext() {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  GLFWwindow* const hidden = glfwCreateWindow(1, 1, "", nullptr, window_);
  glfwDefaultWindowHints();
  if (!hidden) return nullptr;
  hidden_.push_back(hidden);
  return std::make_unique<HiddenContext>(hidden);
}

void Window::listen() {
  static constexpr auto of = [](GLFWwindow* window) -> Window& {
    return *static_cast<Window*>(glfwGetWindowUserPointer(window));
  };
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
    if (action == GLFW_RELEASE) return;
    Window& here = of(window);
    here.repeats_ = action == GLFW_REPEAT;
    if (!here.repeats_ || std::ranges::count(kRepeating, key) > 0) here.keys_.push_back(key);
  });
  glfwSetCharCallback(window_, [](GLFWwindow* window, unsigned typed) {
    Window& here = of(window);
    if (!here.repeats_) here.typed_.push_back(typed);
  });
  glfwSetScrollCallback(window_,
                        [](GLFWwindow* window, double, double up) { of(window).wheel_ += up; });
  glfwSetWindowSizeCallback(window_, [](GLFWwindow* window, int width, int height) {
    Window& here = of(window);
    here.size_px_ = {width, height};
    glfwGetCursorPos(window, &here.cursor_px_.x, &here.cursor_px_.y);  // no motion is told
  });
  glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* window, int width, int height) {
    of(window).frame_buffer_px_ = {width, height};
  });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
    of(window).cursor_px_ = {x, y};
  });
  glfwSetCursorEnterCallback(
      window_, [](GLFWwindow* window, int entered) { of(window).hovered_ = entered == GLFW_TRUE; });
  int width = 0, height = 0;
  glfwGetWindowSize(window_, &width, &height);
  size_px_ = {width, height};
  glfwGetFramebufferSize(window_, &frame_buffer_px_.x, &frame_buffer_px_.y);
  glfwGetCursorPos(window_, &cursor_px_.x, &cursor_px_.y);
  hovered_ = glfwGetWindowAttrib(window_, GLFW_HOVERED) != 0;
  glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
    auto& dropped = of(window).dropped_;
    dropped.insert(dropped.end(), paths, paths + count);
  });
}

double Window::takeWheel() { return std::exchange(wheel_, 0.0); }

std::vector<std::filesystem::path> Window::takeDropped() { return std::exchange(dropped_, {}); }

bool Window::isDown(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }

void Window::toggleFullScreen() {
  glm::ivec4& px = windowed_px_;
  if (glfwGetWindowMonitor(window_)) {
    glfwSetWindowMonitor(window_, nullptr, px[0], px[1], px[2], px[3], GLFW_DONT_CARE);
  } else if (const GLFWvidmode* mode = monitor_ ? glfwGetVideoMode(monitor_) : nullptr) {
    glfwGetWindowPos(window_, &px[0], &px[1]);
    glfwGetWindowSize(window_, &px[2], &px[3]);
    glfwSetWindowMonitor(window_, monitor_, 0, 0, mode->width, mode->height, mode->refreshRate);
  }
}

std::vector<int> Window::takeKeys() { return std::exchange(keys_, {}); }

std::vector<unsigned> Window::takeTyped() { return std::exchange(typed_, {}); }

bool Window::isPressed(int key, bool repeat) { return ImGui::IsKeyPressed(keyOf(key), repeat); }

bool Window::isButtonDown(int button) const {
  return glfwGetMouseButton(window_, button) == GLFW_PRESS;
}

bool Window::wait(double seconds) {
  glfwWaitEventsTimeout(std::max(seconds, 1e-4));
  return !glfwWindowShouldClose(window_);
}

void Window::wake() { glfwPostEmptyEvent(); }

double Window::refresh_Hz() const {
  const GLFWvidmode* mode = monitor_ ? glfwGetVideoMode(monitor_) : nullptr;
  return mode && mode->refreshRate > 0 ? mode->refreshRate : 60.0;
}

bool Window::begin(const glm::vec3& background, bool has_panels) {
  glfwPollEvents();
  if (glfwWindowShouldClose(window_)) return false;
  const glm::ivec2 size_px = frameBufferSize_px();
  glViewport(0, 0, size_px.x, size_px.y);
  glClearColor(background.r, background.g, background.b, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_NewFrame();
  ImGuiIO& io = ImGui::GetIO();
  if (has_panels) {
    ImGui_ImplGlfw_NewFrame();
  } else {
    io.DisplaySize = {static_cast<float>(size_px_.x), static_cast<float>(size_px_.y)};
    io.MousePos = {-FLT_MAX, -FLT_MAX};
    std::ranges::fill(io.MouseDown, false);
  }
  ImGui::NewFrame();
  return true;
}

void Window::end() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSwapBuffers(window_);
}

void Window::resize(const glm::ivec2& size_px) { glfwSetWindowSize(window_, size_px.x, size_px.y); }

double Window::time_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

std::optional<glm::dvec2> Window::monitorSize_m() const {
  int width_mm = 0, height_mm = 0;
  if (monitor_) glfwGetMonitorPhysicalSize(monitor_, &width_mm, &height_mm);
  if (width_mm <= 0 || height_mm <= 0) return std::nullopt;
  return glm::dvec2(width_mm, height_mm) / 1000.0;
}

glm::ivec2 Window::monitorSize_px() const {
  if (!monitor_) return glm::ivec2(size_px());
  const GLFWvidmode* mode = glfwGetVideoMode(monitor_);
  return {mode->width, mode->height};
}

Texture::~Texture() {
  if (frame_buffer_ != 0) glDeleteFramebuffers(1, &frame_buffer_);
  if (id_ != 0) glDeleteTextures(1, &id_);
}

void Texture::set(const glm::ivec2& size_px, const unsigned char* rgb) {
  if (id_ == 0) glGenTextures(1, &id_);
  glBindTexture(GL_TEXTURE_2D, id_);
  // BGRA without a size in the format's name matches the pixels of windows: then neither upload nor
  // `fill` converts a pixel. Software OpenGL spends about a tenth of a frame on such conversions.
  const cv::Mat from(size_px.y, size_px.x, CV_8UC3, const_cast<unsigned char*>(rgb));
  bgra_.resize(4 * static_cast<std::size_t>(size_px.x) * size_px.y);
  cv::Mat to(size_px.y, size_px.x, CV_8UC4, bgra_.data());
  cv::cvtColor(from, to, cv::COLOR_RGB2BGRA);
  constexpr GLenum kOrder = GL_BGRA, kType = GL_UNSIGNED_BYTE;
  if (size_px == size_px_) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, size_px.x, size_px.y, kOrder, kType, bgra_.data());
    return;
  }
  size_px_ = size_px;
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, size_px.x, size_px.y, 0, kOrder, kType, bgra_.data());
}

Area Area::inside(const glm::ivec2& frame_buffer_px, const glm::ivec2& shape_px) {
  const glm::dvec2 ratio = glm::dvec2(frame_buffer_px) / glm::dvec2(shape_px);
  const glm::ivec2 size_px(glm::round(std::min(ratio.x, ratio.y) * glm::dvec2(shape_px)));
  return {(frame_buffer_px - size_px) / 2, size_px};
}

void Texture::fill(const Area& area, int views) { fillFrom(id_, size_px_, area, views); }

void Texture::fillFrom(unsigned texture, const glm::ivec2& texture_px, const Area& area,
                       int views) {
  if (frame_buffer_ == 0) glGenFramebuffers(1, &frame_buffer_);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, frame_buffer_);
  // Attached anew each time: another context may have written it.
  glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
  // Rows of the image start at the top, rows of the frame buffer at the bottom.
  std::array<GLint, 4> viewport{};  // the frame buffer, as of `begin`
  glGetIntegerv(GL_VIEWPORT, viewport.data());
  const glm::ivec2 first = area.corner_px, last = first + area.size_px;
  glBlitFramebuffer(0, 0, texture_px.x / views, texture_px.y, first.x, viewport[3] - first.y,
                    last.x, viewport[3] - last.y, GL_COLOR_BUFFER_BIT,
                    area.size_px == texture_px ? GL_NEAREST : GL_LINEAR);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
}

void* Texture::id() const {
  // Dear ImGui identifies textures by pointers.  NOLINTNEXTLINE(performance-no-int-to-ptr)
  return reinterpret_cast<void*>(static_cast<std::uintptr_t>(id_));
}

}  // namespace foci
