#include "app/window/display.h"

#include <GL/gl.h>
#include <GLFW/glfw3.h>

#include "app/window/window.h"

namespace foci {
namespace {

std::string textOf(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "unknown";
}

std::vector<MonitorFacts> monitors() {
  int count = 0;
  GLFWmonitor** all = glfwGetMonitors(&count);
  std::vector<MonitorFacts> facts;
  for (int i = 0; i < count; ++i) {
    MonitorFacts monitor{.name = glfwGetMonitorName(all[i])};
    if (const GLFWvidmode* mode = glfwGetVideoMode(all[i])) {
      monitor.size_px = {mode->width, mode->height};
      monitor.refresh_Hz = mode->refreshRate;
    }
    glfwGetMonitorPhysicalSize(all[i], &monitor.size_mm.x, &monitor.size_mm.y);
    facts.push_back(monitor);
  }
  return facts;
}

}  // namespace

DisplayFacts describeDisplay() {
  DisplayFacts facts;
  if (!startGlfw()) {
    facts.problem = "no display: foci live and calibration windows need one";
    return facts;
  }
  facts.monitors = monitors();
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  if (GLFWwindow* window = glfwCreateWindow(64, 64, "foci doctor", nullptr, nullptr)) {
    glfwMakeContextCurrent(window);
    facts.opengl = textOf(GL_VERSION);
    facts.renderer = textOf(GL_RENDERER);
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &facts.texture_px);
    glfwDestroyWindow(window);
  } else {
    facts.problem = "no OpenGL 3.3: its driver is missing (libgl1-mesa-dri renders in software)";
  }
  glfwTerminate();
  return facts;
}

}  // namespace foci
