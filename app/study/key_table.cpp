#include "app/study/key_table.h"

#include <algorithm>
#include <cctype>

#include "base/nearest.h"

namespace foci {
namespace {

/// A word that people use for what a key sets.
struct Synonym {
  std::string_view section;  ///< of the unknown key; empty: any
  std::string_view word;     ///< the unknown key without section and unit
  std::string_view key;
};

constexpr Synonym kSynonyms[] = {
    {"", "aperture", "observer.pupil_mm"},
    {"", "pupil_diameter", "observer.pupil_mm"},
    {"", "pupil_size", "observer.pupil_mm"},
    {"observer", "diameter", "observer.pupil_mm"},
    {"", "interpupillary_distance", "observer.ipd_mm"},
    {"", "interocular_distance", "observer.ipd_mm"},
    {"", "eye_separation", "observer.ipd_mm"},
    {"", "prescription", "observer.sphere_D"},
    {"", "spherical", "observer.sphere_D"},
    {"", "astigmatism", "observer.cylinder_D"},
    {"observer", "glasses", "observer.corrected"},
    {"observer", "accommodation", "focus.accommodation"},
    {"gaze", "file", "gaze.source"},
    {"gaze", "path", "gaze.source"},
    {"", "trace", "gaze.source"},
    {"", "recording", "gaze.source"},
    {"gaze", "timestamp", "gaze.time"},
    {"gaze", "sampling_rate", "gaze.rate_Hz"},
    {"scene", "path", "scene.file"},
    {"scene", "mesh", "scene.file"},
    {"scene", "model", "scene.file"},
    {"scene", "points", "scene.file"},
    {"scene", "unit", "scene.scale_m"},
    {"scene", "units", "scene.scale_m"},
    {"scene", "colour", "scene.background"},
    {"scene", "color", "scene.background"},
    {"eye", "target", "eye.look_at_m"},
    {"eye", "direction", "eye.look_at_m"},
    {"eye", "location", "eye.position_m"},
    {"camera", "target", "eye.look_at_m"},
    {"camera", "position", "eye.position_m"},
    {"camera", "look_at", "eye.look_at_m"},
    {"screen", "resolution", "screen.size_px"},
    {"screen", "width", "screen.size_m"},
    {"screen", "height", "screen.size_m"},
    {"", "viewing_distance", "screen.distance_m"},
    {"screen", "brightness", "screen.luminance_cd_m2"},
    {"output", "resolution", "output.size_px"},
    {"output", "width", "output.size_px"},
    {"output", "height", "output.size_px"},
    {"", "framerate", "output.fps"},
    {"", "frame_rate", "output.fps"},
    {"", "frames_per_second", "output.fps"},
    {"output", "duration", "output.seconds"},
    {"output", "frames", "output.images"},
    {"output", "png", "output.images"},
    {"output", "stereo", "output.view"},
    {"output", "cursor", "output.marker"},
    {"focus", "distance", "focus.fixed_D"},
    {"", "focus_distance", "focus.fixed_D"},
    {"", "focal_distance", "focus.fixed_D"},
    {"render", "algorithm", "render.method"},
    {"render", "mode", "render.method"},
    {"quality", "error", "quality.tolerance"},
    {"quality", "max_error", "quality.tolerance"},
    {"quality", "budget", "quality.frame_ms"},
    {"quality", "level", "render.method"},
    {"", "random_seed", "seed"},
};

constexpr std::string_view kUnits[] = {"mm", "m",  "cm", "px", "deg",   "D",  "s",
                                       "ms", "Hz", "hz", "d",  "years", "um", "cd_m2"};

std::string_view sectionOf(std::string_view key) {
  const std::size_t dot = key.find('.');
  return dot == key.npos ? std::string_view() : key.substr(0, dot);
}

std::string_view leafOf(std::string_view key) {
  const std::size_t dot = key.find('.');
  return dot == key.npos ? key : key.substr(dot + 1);
}

/// The leaf without its unit.
std::string_view stemOf(std::string_view key) {
  const std::string_view leaf = leafOf(key);
  for (const std::string_view unit : kUnits) {
    if (leaf.size() > unit.size() + 1 && leaf.ends_with(unit) &&
        leaf[leaf.size() - unit.size() - 1] == '_') {
      return leaf.substr(0, leaf.size() - unit.size() - 1);
    }
  }
  return leaf;
}

bool isKnown(const std::vector<std::string>& known, std::string_view key) {
  return std::find(known.begin(), known.end(), key) != known.end();
}

/// The first known key of which this holds.
template <class Holds>
std::optional<std::string> first(const std::vector<std::string>& known, const Holds& holds) {
  const auto found = std::find_if(known.begin(), known.end(), holds);
  return found == known.end() ? std::nullopt : std::optional(*found);
}

/// The key of the same section, or of a misspelt one, whose leaf or stem is nearest.
std::optional<std::string> misspelt(std::string_view unknown,
                                    const std::vector<std::string>& known) {
  const std::string_view section = sectionOf(unknown), leaf = leafOf(unknown);
  std::vector<std::string> near;
  for (const std::string& key : known) {
    const bool same = sectionOf(key) == section || isMisspelt(section, sectionOf(key));
    if (same && isMisspelt(leaf, leafOf(key))) near.push_back(key);
  }
  if (near.empty()) return std::nullopt;
  return nearest(unknown, near);
}

}  // namespace

std::optional<std::string> suggestedKey(std::string_view unknown,
                                        const std::vector<std::string>& known) {
  if (unknown.size() > 64) return std::nullopt;
  const std::string_view section = sectionOf(unknown), leaf = leafOf(unknown);
  const std::string_view stem = stemOf(unknown);
  for (const Synonym& synonym : kSynonyms) {
    const bool section_fits = synonym.section.empty() || synonym.section == section;
    if (section_fits && synonym.word == stem && isKnown(known, synonym.key)) {
      return std::string(synonym.key);
    }
  }
  // The same name misspelt, with another unit, or in another section.
  if (auto key = misspelt(unknown, known)) return key;
  if (auto key = first(known, [&](const std::string& one) {
        return sectionOf(one) == section && stemOf(one) == stem;
      })) {
    return key;
  }
  constexpr std::size_t kDistinctive = 3;  // letters; "x" of another section tells nothing
  if (stem.size() < kDistinctive) return std::nullopt;
  if (auto key = first(known, [&](const std::string& one) { return leafOf(one) == leaf; })) {
    return key;
  }
  return first(known, [&](const std::string& one) { return stemOf(one) == stem; });
}

std::vector<std::string> sectionsOf(const std::vector<std::string>& known) {
  std::vector<std::string> sections;
  for (const std::string& key : known) {
    const std::string section(sectionOf(key));
    if (!section.empty() && !isKnown(sections, section)) sections.push_back(section);
  }
  return sections;
}

}  // namespace foci
