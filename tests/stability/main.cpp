// foci_stability [--full] [--out DIR] [METHOD...]: every scene of app/stability_scenes.h at every
// value of its dial, scored for each method. A table (tab-separated) to standard output, and to
// DIR/scores.tsv.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "app/stability_scenes.h"
#include "render/image/image_file.h"
#include "render/methods/method.h"

namespace {

/// The scene at its dial's end as each method draws it, and as the reference does, side by side.
void writePictures(const foci::StabilityScene& scene, std::vector<std::string> methods,
                   const std::filesystem::path& out) {
  methods.emplace_back("accumulate:200");
  const auto setup = scene.setup(scene.values.back());
  foci::Frame sheet;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const foci::Frame frame = foci::stabilityFrame(setup, methods[m]);
    const auto count = static_cast<int>(methods.size());
    sheet.size_px = {frame.size_px.x * count, frame.size_px.y};
    sheet.rgba.resize(frame.rgba.size() * methods.size());
    for (int y = 0; y < frame.size_px.y; ++y) {
      std::copy_n(&frame.rgba[static_cast<std::size_t>(y * frame.size_px.x)], frame.size_px.x,
                  &sheet.rgba[static_cast<std::size_t>(y * sheet.size_px.x) +
                              m * static_cast<std::size_t>(frame.size_px.x)]);
    }
  }
  std::string name(scene.name);
  for (char& c : name) c = c == ' ' ? '-' : c;
  std::erase(name, ',');
  foci::writeImage(out / (name + ".png"), sheet);
}

}  // namespace

int main(int argc, char** argv) {
  foci::StabilityEffort effort;
  std::filesystem::path out;
  std::vector<std::string> methods;
  std::string only;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--full") {
      effort = {.views = 400, .every_value = true};
    } else if (argument == "--out" && i + 1 < argc) {
      out = argv[++i];
    } else if (argument == "--scene" && i + 1 < argc) {
      only = argv[++i];
    } else if (!foci::expectedMethod(argument)) {
      methods.push_back(argument);
    } else {
      std::fprintf(stderr,
                   "usage: foci_stability [--full] [--out DIR] [--scene NAME] [METHOD...]\n");
      return 2;
    }
  }
  if (methods.empty()) {
    if (effort.every_value) {
      for (const foci::MethodInfo& info : foci::methods()) methods.emplace_back(info.name);
    } else {
      methods = {"paper-lod", "sweep", "sweep-lod"};
    }
  }
  if (!out.empty()) std::filesystem::create_directories(out);
  std::string table = "scene\tdial\tvalue\tmethod\tscore\tof\n";
  for (const foci::StabilityScene& scene : foci::stabilityScenes()) {
    if (!only.empty() && only != scene.name) continue;
    for (const float value : effort.every_value ? scene.values : scene.short_values) {
      const auto scores = foci::stabilityScores(scene, value, methods, effort);
      for (std::size_t i = 0; i < methods.size(); ++i) {
        char row[400];
        std::snprintf(row, sizeof(row), "%s\t%s\t%g\t%s\t%.4f\t%s\n", scene.name.data(),
                      scene.dial.data(), static_cast<double>(value), methods[i].c_str(), scores[i],
                      scene.score.data());
        table += row;
        std::fputs(row, stdout);
        std::fflush(stdout);
      }
    }
    if (!out.empty()) writePictures(scene, methods, out);
  }
  if (!out.empty()) {
    std::ofstream(out / "scores.tsv") << table;
  }
  return 0;
}
