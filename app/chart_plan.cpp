#include "app/chart_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "app/base/input_error.h"
#include "app/base/nearest.h"
#include "app/sha256.h"
#include "app/tables.h"
#include "app/timed_runs.h"
#include "render/methods/method.h"

namespace foci {
namespace {

ChartPlan full() {
  return {.quick = false,
          .size_px = 512,
          .blurs_px = {1.0, 4.0, 12.0, 40.0},
          .least_views = 256,
          .most_views = 1024,
          .timing_ms = 300.0,
          .most_runs = 7};
}

ChartPlan quick() {
  return {.quick = true,
          .size_px = 256,
          .blurs_px = {4.0, 16.0},
          .least_views = 64,
          .most_views = 128,
          .timing_ms = 60.0,
          .most_runs = 3};
}

/// Settings besides the standard one, where a method's number is a dial worth seeing turned.
struct Dial {
  std::string_view method;
  std::vector<int> full, quick;
};

const std::vector<Dial>& dials() {
  static const std::vector<Dial> all = {
      {"accumulate", {16, 64, 200}, {16}}, {"raytrace", {1, 4}, {1}},
      {"sweep-lod", {1, 7, 19}, {1, 7}},   {"layered", {4, 8, 32}, {8}},
      {"rasanen", {4, 16, 64}, {16}},      {"shinya", {16, 64}, {16}}};
  return all;
}

std::vector<ChartMethod> everyMethod(bool is_quick) {
  std::vector<ChartMethod> all;
  for (const MethodInfo& info : methods()) {
    const std::string name(info.name);
    if (info.most == 0) {
      all.push_back({name, {}});
      continue;
    }
    const auto dial = std::find_if(dials().begin(), dials().end(),
                                   [&](const Dial& one) { return one.method == name; });
    if (dial == dials().end()) {
      all.push_back({name, info.standard});
      continue;
    }
    for (const int setting : is_quick ? dial->quick : dial->full) all.push_back({name, setting});
  }
  return all;
}

ChartMethod methodOf(const std::string& spec) {
  if (const auto expected = expectedMethod(spec)) {
    throw InputError("--method " + spec, "expected " + *expected);
  }
  const std::size_t colon = spec.find(':');
  if (colon != std::string::npos) return {spec.substr(0, colon), std::stoi(spec.substr(colon + 1))};
  const auto info = std::find_if(methods().begin(), methods().end(),
                                 [&](const MethodInfo& one) { return one.name == spec; });
  return {spec, info->most > 0 ? std::optional(info->standard) : std::nullopt};
}

std::string poseText(const EyePose& pose) {
  std::string text;
  for (const glm::vec3& v : {pose.position_m, pose.target_m, pose.up}) {
    for (int i = 0; i < 3; ++i) text += decimal(v[i], 6) + " ";
  }
  return text;
}

std::vector<ChartScene> everyScene(int size_px, const std::optional<ScanView>& scan) {
  std::vector<ChartScene> all;
  if (scan) {  // first, should there be something wrong with it
    all.push_back({"scan", scan->file.filename().string(),
                   sha256OfFile(scan->file) + " " + poseText(scan->pose),
                   [=, view = *scan] { return scanInView(view, size_px); }});
  }
  all.push_back(
      {"plane", "a textured plane, tilted", "", [=] { return planeInView(512, size_px); }});
  all.push_back({"gallery", "a gallery, things from 0.25 to 6 m", "",
                 [=] { return galleryInView(size_px); }});
  all.push_back({"mask", "a half-transparent mask before a figure in focus", "",
                 [=] { return maskInView(size_px); }});
  all.push_back(
      {"fence", "thin wires before a wall in focus", "", [=] { return fenceInView(size_px); }});
  if (!scan) {
    all.push_back({"statue", "a stone lion", "", [=] { return statueInView(size_px); }});
  }
  return all;
}

}  // namespace

int ChartPlan::views(double blur_px) const {
  const double views = std::ceil(std::numbers::pi * blur_px * blur_px);
  return static_cast<int>(std::clamp(views, double{1.0 * least_views}, double{1.0 * most_views}));
}

ChartPlan planChart(const ChartChoice& choice) {
  ChartPlan plan = choice.quick ? quick() : full();
  plan.size_px = choice.size_px.value_or(plan.size_px);
  plan.threads = threadCounts();
  plan.scenes = everyScene(plan.size_px, choice.scan);
  if (!choice.scenes.empty()) {
    std::vector<std::string> known;
    for (const ChartScene& one : plan.scenes) known.push_back(one.id);
    for (const std::string& id : choice.scenes) {
      if (std::find(known.begin(), known.end(), id) == known.end()) {
        throw InputError("--scene " + id,
                         "expected a known scene; the nearest is " + nearest(id, known));
      }
    }
    std::erase_if(plan.scenes, [&](const ChartScene& one) {
      return std::find(choice.scenes.begin(), choice.scenes.end(), one.id) == choice.scenes.end();
    });
  }
  if (choice.methods.empty()) {
    plan.methods = everyMethod(choice.quick);
  } else {
    for (const std::string& spec : choice.methods) plan.methods.push_back(methodOf(spec));
  }
  return plan;
}

}  // namespace foci
