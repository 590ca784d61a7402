#include "app/cli/doctor_command.h"

#include <tbb/global_control.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "app/live/sources.h"
#include "app/platform/machine.h"
#include "app/window/display.h"
#include "base/text.h"

namespace foci {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kMmPerInch = 25.4;
constexpr double kPatience_s = 0.5;  // for a tracker to answer

std::string firstLineOf(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

Json displayJson(const DisplayFacts& display) {
  Json json = {{"opengl", nullptr}, {"monitors", Json::array()}};
  if (!display.opengl.empty()) {
    json["opengl"] = {{"version", display.opengl},
                      {"renderer", display.renderer},
                      {"texture_px", display.texture_px}};
  }
  if (!display.problem.empty()) json["problem"] = display.problem;
  for (const MonitorFacts& monitor : display.monitors) {
    Json entry = {{"name", monitor.name},
                  {"size_px", {monitor.size_px.x, monitor.size_px.y}},
                  {"size_mm", nullptr},
                  {"dpi", nullptr},
                  {"refresh_Hz", monitor.refresh_Hz}};
    if (monitor.size_mm.x > 0 && monitor.size_mm.y > 0) {
      entry["size_mm"] = {monitor.size_mm.x, monitor.size_mm.y};
      entry["dpi"] = std::round(10.0 * kMmPerInch * monitor.size_px.x / monitor.size_mm.x) / 10.0;
    }
    json["monitors"].push_back(entry);
  }
  return json;
}

/// The system's list: a camera that is in use is there, too.
Json camerasJson() {
  Json cameras = Json::array();
  std::error_code none;
  std::vector<fs::path> nodes;
  for (const auto& entry : fs::directory_iterator("/sys/class/video4linux", none)) {
    // A camera has further nodes for what is no image.
    if (firstLineOf(entry.path() / "index") == "0") nodes.push_back(entry.path());
  }
  std::sort(nodes.begin(), nodes.end());
  for (const fs::path& node : nodes) {
    const std::string device = "/dev/" + node.filename().string();
    cameras.push_back({{"device", device},
                       {"source", "webcam:" + node.filename().string().substr(5)},
                       {"name", firstLineOf(node / "name")},
                       {"allowed", access(device.c_str(), R_OK | W_OK) == 0}});
  }
  return cameras;
}

bool answers(const std::string& place) {
  const NamedSource tracker = openLiveSource("pupil:" + place, Study{});
  std::vector<GazeSample> samples;
  for (double now_s = 0.0; now_s < kPatience_s; now_s += 0.01) {
    tracker.source->poll(now_s, samples);
    if (tracker.source->status().find("no answer") == std::string::npos) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

Json trackersJson(const std::string& place) {
#ifdef FOCI_PUPIL
  return Json::array({{{"name", "Pupil Core"}, {"place", place}, {"answers", answers(place)}}});
#else
  (void)place;
  return Json::array();
#endif
}

/// Of packages.txt, those that Debian's own list does not have.
Json packagesJson() {
  Json json = {{"missing", Json::array()}, {"install", nullptr}};
  std::ifstream status("/var/lib/dpkg/status");
  if (!status) {
    json["problem"] = "no Debian packages here: see app/packages.txt for what is needed";
    return json;
  }
  std::vector<std::string> installed;
  std::string name;
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("Package: ")) name = line.substr(9);
    if (line == "Status: install ok installed") installed.push_back(name);
  }
  std::istringstream wanted(FOCI_PACKAGES);
  std::string command;
  while (wanted >> name) {
    if (std::find(installed.begin(), installed.end(), name) != installed.end()) continue;
    json["missing"].push_back(name);
    command += " " + name;
  }
  if (!command.empty()) json["install"] = "apt-get install --no-install-recommends" + command;
  return json;
}

Json examine(const std::string& pupil) {
  const Machine machine = describeMachine();
  return {
      {"version", FOCI_VERSION},
      {"cpu", machine.cpu},
      {"cores", machine.cores},
      {"simd", machine.simd},
      {"threads", tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)},
      {"system", machine.system},
      {"display", displayJson(describeDisplay())},
      {"cameras", camerasJson()},
      {"trackers", trackersJson(pupil)},
      {"packages", packagesJson()}};
}

void printText(const Json& facts) {
  const auto text = [](const Json& json) {
    return json.is_string() ? json.get<std::string>() : json.dump();
  };
  const auto say = [](const char* what, const std::string& value) {
    std::printf("%-10s %s\n", what, value.c_str());
  };
  say("foci", text(facts["version"]) + ", " + text(facts["system"]));
  say("CPU", text(facts["cpu"]) + "; " + text(facts["cores"]) + " cores, " +
                 text(facts["threads"]) + " threads, SIMD " + text(facts["simd"]));
  const Json& display = facts["display"];
  if (!display["opengl"].is_null()) {
    const Json& opengl = display["opengl"];
    say("OpenGL", text(opengl["version"]) + "; " + text(opengl["renderer"]) + "; textures up to " +
                      text(opengl["texture_px"]) + " px");
  }
  if (display.contains("problem")) say("OpenGL", text(display["problem"]));
  int number = 0;
  for (const Json& monitor : display["monitors"]) {
    std::string line = std::to_string(number++) + ": " + text(monitor["name"]) + ", " +
                       text(monitor["size_px"][0]) + "x" + text(monitor["size_px"][1]) + " px";
    if (!monitor["dpi"].is_null()) {
      line += ", " + text(monitor["size_mm"][0]) + "x" + text(monitor["size_mm"][1]) + " mm (" +
              text(monitor["dpi"]) + " dpi, as it says itself)";
    }
    say("monitor", line + ", " + text(monitor["refresh_Hz"]) + " Hz");
  }
  for (const Json& camera : facts["cameras"]) {
    say("camera", text(camera["source"]) + ": " + text(camera["name"]) +
                      (camera["allowed"].get<bool>() ? "" : "; not allowed (group video?)"));
  }
  if (facts["cameras"].empty()) say("camera", "none");
  for (const Json& tracker : facts["trackers"]) {
    say("tracker", text(tracker["name"]) + " at " + text(tracker["place"]) +
                       (tracker["answers"].get<bool>() ? ": answers" : ": no answer"));
  }
  const Json& packages = facts["packages"];
  if (packages.contains("problem")) {
    say("packages", text(packages["problem"]));
  } else if (packages["missing"].empty()) {
    say("packages", "all there");
  } else {
    say("packages", "missing; as root: " + text(packages["install"]));
  }
}

}  // namespace

void addDoctorCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("doctor", "What this machine offers, and what it lacks.");
  struct Options {
    bool json = false;
    std::string pupil = "127.0.0.1:50020";
  };
  const auto options = std::make_shared<Options>();
  command->add_flag("--json", options->json, "as JSON");
  command->add_option("--pupil", options->pupil, "where Pupil Remote may answer")
      ->type_name("HOST:PORT");
  command->callback([options] {
    const Json facts = examine(options->pupil);
    if (options->json) {
      std::puts(facts.dump(-1, ' ', false, Json::error_handler_t::replace).c_str());
    } else {
      printText(facts);
    }
  });
}

}  // namespace foci
