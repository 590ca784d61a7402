// Facts about the machine's displays.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace foci {

struct MonitorFacts {
  std::string name;
  glm::ivec2 size_px{0, 0};
  glm::ivec2 size_mm{0, 0};  ///< 0: the monitor does not state it
  double refresh_Hz = 0.0;
};

struct DisplayFacts {
  std::string problem;                 ///< the reason if the other fields are empty
  std::string opengl, renderer;        ///< as the driver states them
  int texture_px = 0;                  ///< max width and height of a texture
  std::vector<MonitorFacts> monitors;  ///< in the order of `foci live --monitor`
};

/// Opens a hidden window for a moment to ask OpenGL.
DisplayFacts describeDisplay();

}  // namespace foci
