// What the machine's display offers.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace foci {

struct MonitorFacts {
  std::string name;
  glm::ivec2 size_px{0, 0};
  glm::ivec2 size_mm{0, 0};  ///< 0: it does not say
  double refresh_Hz = 0.0;
};

struct DisplayFacts {
  std::string problem;                 ///< why what follows is empty; "" where it is not
  std::string opengl, renderer;        ///< as the driver names them
  int texture_px = 0;                  ///< widest and highest texture
  std::vector<MonitorFacts> monitors;  ///< as `foci live --monitor` counts them
};

/// Opens a hidden window for a moment.
DisplayFacts describeDisplay();

}  // namespace foci
