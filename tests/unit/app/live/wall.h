// The scene of the tests of `foci live`.
#pragma once

#include <string>

namespace foci {

/// A wall of 2 m x 1.5 m as points (PLY): the left part is 2 m away, the right part 1 m.
inline std::string wallPly() {
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1200\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  for (int i = 0; i < 1200; ++i) {
    const double x = 0.05 * (i % 40 - 19.5), y = 0.05 * (i / 40 - 14.5);
    ply += std::to_string(x) + " " + std::to_string(y) + (x > 0 ? " -1\n" : " -2\n");
  }
  return ply;
}

}  // namespace foci
