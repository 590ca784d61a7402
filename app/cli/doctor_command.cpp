#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "app/cli/commands.h"
#include "app/live/sources.h"
#include "app/platform/json_text.h"
#include "app/platform/machine.h"
#include "app/platform/version.h"
#include "app/study/load_scene.h"
#include "app/window/display.h"
#include "base/text.h"
#include "gaze/webcam/face_networks.h"
#include "render/gl/device.h"

namespace foci {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMmPerInch = 25.4;
constexpr double kPatience_s = 0.5;  // time for a tracker to answer, chosen by eye

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

Json camerasJson() {
  Json json = Json::array();
  for (const Camera& camera : cameras()) {
    json.push_back({{"device", camera.device},
                    {"source", "webcam:" + camera.device.substr(sizeof("/dev/video") - 1)},
                    {"name", camera.name},
                    {"allowed", camera.allowed}});
  }
  return json;
}

/// The networks of the webcam tracker.
Json webcamModelsJson() {
  Json json = {{"folder", FaceNetworks::folder().string()}, {"missing", FaceNetworks::missing()}};
  if (!json["missing"].empty()) json["install"] = "sh app/webcam_models.sh";
  return json;
}

/// The scenes that were opened before.
Json cacheJson() {
  const auto folder = SceneCache::userFolder();
  if (!folder) return nullptr;
  const SceneCache::Content content = SceneCache(*folder).content();
  return {{"folder", folder->string()}, {"scenes", content.entries}, {"bytes", content.bytes}};
}

#ifdef FOCI_PUPIL
bool trackerAnswers(const std::string& place) {
  const auto tracker = openPupil("pupil:" + place, {});
  std::vector<GazeSample> samples;
  for (double now_s = 0.0; now_s < kPatience_s; now_s += 0.01) {
    tracker->poll(now_s, samples);
    if (tracker->status().find("no answer") == std::string::npos) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}
#endif

Json trackersJson(const std::string& place) {
#ifdef FOCI_PUPIL
  return Json::array(
      {{{"name", "Pupil Core"}, {"place", place}, {"answers", trackerAnswers(place)}}});
#else
  (void)place;
  return Json::array();
#endif
}

/// The packages of packages.txt that Debian does not list as installed.
Json packagesJson() {
  Json json = {{"missing", Json::array()}, {"install", nullptr}};
  if (cameWithPackage()) return json;
  const auto installed = installedPackages();
  if (!installed) {
    json["problem"] =
        "no Debian packages here: app/packages.txt lists the packages that foci needs";
    return json;
  }
  std::istringstream wanted(FOCI_PACKAGES);
  std::string command;
  for (std::string name; wanted >> name;) {
    if (std::ranges::find(*installed, name) != installed->end()) continue;
    json["missing"].push_back(name);
    command += " " + name;
  }
  if (!command.empty()) json["install"] = "apt-get install --no-install-recommends" + command;
  return json;
}

/// What `render.device = "gpu"` would render on.
Json gpuJson() {
  try {
    const auto gpu = GpuDevice::open(GpuDevice::Kind::any);
    return {{"name", gpu->name()}, {"driver", gpu->driver()}, {"software", gpu->isSoftware()}};
  } catch (const GpuError& error) {
    return {{"problem", error.what()}};
  }
}

Json examine(const std::string& pupil) {
  const Machine machine = describeMachine();
  return {
      {"version", versionText()},
      {"cpu", machine.cpu},
      {"cores", machine.cores},
      {"simd", machine.simd},
      {"threads", tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)},
      {"system", machine.system},
      {"gpu", gpuJson()},
      {"display", displayJson(describeDisplay())},
      {"cameras", camerasJson()},
      {"webcam_models", webcamModelsJson()},
      {"trackers", trackersJson(pupil)},
      {"cache", cacheJson()},
      {"packages", packagesJson()}};
}

std::string textOfJson(const Json& json) {
  return json.is_string() ? json.get<std::string>() : json.dump();
}

void printFact(const char* what, const std::string& value) {
  std::printf("%-10s %s\n", what, value.c_str());
}

void printDisplay(const Json& display) {
  if (!display["opengl"].is_null()) {
    const Json& opengl = display["opengl"];
    printFact("OpenGL", textOfJson(opengl["version"]) + "; " + textOfJson(opengl["renderer"]) +
                            "; textures up to " + textOfJson(opengl["texture_px"]) + " px");
  }
  if (display.contains("problem")) printFact("OpenGL", textOfJson(display["problem"]));
  int number = 0;
  for (const Json& monitor : display["monitors"]) {
    std::string line = std::to_string(number++) + ": " + textOfJson(monitor["name"]) + ", " +
                       textOfJson(monitor["size_px"][0]) + "x" + textOfJson(monitor["size_px"][1]) +
                       " px";
    if (!monitor["dpi"].is_null()) {
      line += ", " + textOfJson(monitor["size_mm"][0]) + "x" + textOfJson(monitor["size_mm"][1]) +
              " mm (" + textOfJson(monitor["dpi"]) + " dpi, as the monitor states)";
    }
    printFact("monitor", line + ", " + textOfJson(monitor["refresh_Hz"]) + " Hz");
  }
}

void printDoctorText(const Json& facts) {
  printFact("foci", textOfJson(facts["version"]) + ", " + textOfJson(facts["system"]));
  printFact("CPU", textOfJson(facts["cpu"]) + "; " + textOfJson(facts["cores"]) + " cores, " +
                       textOfJson(facts["threads"]) + " threads, SIMD " +
                       textOfJson(facts["simd"]));
  const Json& gpu = facts["gpu"];
  printFact("GPU",
            gpu.contains("problem")
                ? textOfJson(gpu["problem"])
                : textOfJson(gpu["name"]) + ", driver " + textOfJson(gpu["driver"]) +
                      (gpu["software"].get<bool>() ? "; software, so render.device = \"auto\" "
                                                     "takes the CPU"
                                                   : ""));
  printDisplay(facts["display"]);
  for (const Json& camera : facts["cameras"]) {
    printFact("camera", textOfJson(camera["source"]) + ": " + textOfJson(camera["name"]) +
                            (camera["allowed"].get<bool>() ? "" : "; not allowed (group video?)"));
  }
  if (facts["cameras"].empty()) printFact("camera", "none");
  const Json& models = facts["webcam_models"];
  std::string missing;
  for (const Json& name : models["missing"]) missing += " " + textOfJson(name);
  printFact("webcam", missing.empty() ? "networks installed in " + textOfJson(models["folder"])
                                      : "networks missing in " + textOfJson(models["folder"]) +
                                            ":" + missing + "; " + textOfJson(models["install"]));
  for (const Json& tracker : facts["trackers"]) {
    printFact("tracker", textOfJson(tracker["name"]) + " at " + textOfJson(tracker["place"]) +
                             (tracker["answers"].get<bool>() ? ": answers" : ": no answer"));
  }
  const Json& cache = facts["cache"];
  if (!cache.is_null()) {
    printFact("cache", counted(cache["scenes"].get<std::size_t>(), "scene") + ", " +
                           std::to_string(cache["bytes"].get<std::uint64_t>() >> 20) + " MiB in " +
                           textOfJson(cache["folder"]));
  }
  const Json& packages = facts["packages"];
  if (packages.contains("problem")) {
    printFact("packages", textOfJson(packages["problem"]));
  } else if (packages["missing"].empty()) {
    printFact("packages", "all installed");
  } else {
    printFact("packages", "missing; as root: " + textOfJson(packages["install"]));
  }
}

}  // namespace

void addDoctorCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "doctor", "Show the hardware and packages that foci can use here, and what is missing.");
  struct Options {
    bool json = false;
    std::string pupil = "127.0.0.1:50020";
  };
  const auto options = std::make_shared<Options>();
  command->add_flag("--json", options->json, "print the facts as JSON");
  addOption(*command, "--pupil", options->pupil, "HOST:PORT", "address of Pupil Remote");
  command->callback([options] {
    const Json facts = examine(options->pupil);
    if (options->json) {
      std::puts(jsonText(facts).c_str());
    } else {
      printDoctorText(facts);
    }
  });
}

}  // namespace foci
