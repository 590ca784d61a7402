// Makes tests/fake_openxr the OpenXR runtime of this process.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace foci {

class FakeOpenXr {
 public:
  /// @param words  as of fake_openxr.cpp
  explicit FakeOpenXr(const std::string& words = "") {
    setenv("XR_RUNTIME_JSON", FOCI_FAKE_OPENXR_JSON, 1);
    setenv("FOCI_FAKE_OPENXR", words.c_str(), 1);
    setenv("FOCI_FAKE_OPENXR_OUT", folder_.path().c_str(), 1);
  }
  ~FakeOpenXr() {
    for (const char* name : {"XR_RUNTIME_JSON", "FOCI_FAKE_OPENXR", "FOCI_FAKE_OPENXR_OUT"}) {
      unsetenv(name);
    }
  }
  FakeOpenXr(const FakeOpenXr&) = delete;
  FakeOpenXr& operator=(const FakeOpenXr&) = delete;

  std::string read(const std::string& name) const {
    std::ifstream file(folder_.path() / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::string log() const { return read("log.txt"); }

 private:
  TemporaryFolder folder_;
};

/// A binary PPM.
struct ShownImage {
  int width = 0, height = 0;
  std::string rgb;

  explicit ShownImage(const std::string& ppm) {
    int from = 0;
    std::sscanf(ppm.c_str(), "P6\n%d %d\n255\n%n", &width, &height, &from);
    rgb = ppm.substr(static_cast<std::size_t>(from));
  }
  int at(int x, int y, int channel) const {
    return static_cast<unsigned char>(
        rgb.at(static_cast<std::size_t>(3 * (y * width + x) + channel)));
  }
};

}  // namespace foci
