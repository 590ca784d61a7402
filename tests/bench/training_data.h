// Labelled recordings for training, and copies of them as other trackers would have recorded them.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "gaze/sources/trace_reader.h"

namespace foci {

/// A recording, and the group that is left out together with it.
struct LabelledRecording {
  std::string set, kind, name;
  std::filesystem::path file;
  LabelledTrace labelled;
};

/// Uniform and normal random numbers that are the same with every library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double uniform() {  // SplitMix64 (Steele, Lea and Flood 2014)
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15ULL;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  double normal() {
    return std::sqrt(-2.0 * std::log(1.0 - uniform())) *
           std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

/// Files that state a wrong rate (README.md of the labelled recordings).
inline double trueRate_Hz(const std::string& name, double stated_Hz) {
  return name == "img_UH47_img_Europe" ? 200.0 : stated_Hz;
}

inline std::vector<LabelledRecording> readRecordings(const std::filesystem::path& folder) {
  const Screen nominal{.size_px = {1000, 1000}, .size_m = {1.0, 1.0}, .distance_m = 1.0};
  std::vector<LabelledRecording> all;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".tsv") continue;
    LabelledRecording each{.set = entry.path().parent_path().filename().string(),
                           .kind = {},
                           .name = entry.path().stem().string(),
                           .file = entry.path(),
                           .labelled = readLabelledTrace(entry.path(), nominal)};
    if (each.set.starts_with("andersson2017")) each.set = "andersson2017";
    each.kind = each.set == "andersson2017" ? each.name.substr(0, each.name.find('_')) : each.set;
    GazeTrace& trace = each.labelled.trace;
    const double rate_Hz = trueRate_Hz(each.name, trace.rate_Hz);
    for (GazeSample& sample : trace.samples) sample.time_s *= trace.rate_Hz / rate_Hz;
    trace.rate_Hz = rate_Hz;
    all.push_back(std::move(each));
  }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return std::tie(a.set, a.name) < std::tie(b.set, b.name);
  });
  return all;
}

struct CopySettings {
  double rate_Hz = 0.0;    ///< 0: as recorded
  double noise_deg = 0.0;  ///< white, SD along each axis
  double rounding_deg = 0.0;
  double lost = 0.0;  ///< share of the samples
};

/// The recording at another rate, with more noise. Positions between two samples follow a cubic
/// (Catmull and Rom 1974), labels are those of the nearest sample.
inline LabelledTrace copyOf(const LabelledTrace& original, const CopySettings& settings,
                            Random& random) {
  const GazeTrace& from = original.trace;
  LabelledTrace copy{.trace = from, .coders = {}};
  for (const Coder& coder : original.coders) copy.coders.push_back({.name = coder.name});
  GazeTrace& to = copy.trace;
  to.samples.clear();
  const double rate_Hz = settings.rate_Hz > 0.0 ? settings.rate_Hz : from.rate_Hz;
  to.rate_Hz = rate_Hz;
  const double px_deg = from.screen->distance_m * std::tan(glm::radians(1.0)) *
                        from.screen->size_px.x / from.screen->size_m.x;
  const auto count = static_cast<std::ptrdiff_t>(from.samples.size());
  const auto point = [&](std::ptrdiff_t i) {
    return from.samples[std::clamp<std::ptrdiff_t>(i, 0, count - 1)].point_px;
  };
  for (double k = 0.0;; k += 1.0) {
    const double at = k / rate_Hz * from.rate_Hz;
    const auto i = static_cast<std::ptrdiff_t>(std::floor(at + 1e-6));
    if (i >= count) break;
    const double t = std::max(at - static_cast<double>(i), 0.0);
    const auto nearest = std::min(t < 0.5 ? i : i + 1, count - 1);
    GazeSample sample = from.samples[nearest];
    sample.time_s = from.samples[0].time_s + k / rate_Hz;
    const auto a = point(i - 1), b = point(i), c = point(i + 1), d = point(i + 2);
    if (sample.point_px && t > 1e-3 && a && b && c && d) {
      sample.point_px =
          0.5 * (2.0 * *b + t * (*c - *a) + t * t * (2.0 * *a - 5.0 * *b + 4.0 * *c - *d) +
                 t * t * t * (3.0 * *b - *a - 3.0 * *c + *d));
    }
    if (sample.point_px) {
      if (settings.noise_deg > 0.0) {
        const double x = random.normal(), y = random.normal();
        *sample.point_px += px_deg * settings.noise_deg * glm::dvec2(x, y);
      }
      if (settings.rounding_deg > 0.0) {
        const double step_px = px_deg * settings.rounding_deg;
        *sample.point_px = step_px * glm::round(*sample.point_px / step_px);
      }
      if (settings.lost > 0.0 && random.uniform() < settings.lost) sample.point_px.reset();
    }
    to.samples.push_back(sample);
    for (std::size_t coder = 0; coder < copy.coders.size(); ++coder) {
      copy.coders[coder].labels.push_back(original.coders[coder].labels[nearest]);
    }
  }
  return copy;
}

}  // namespace foci
