#include "app/study/key_table.h"

#include <sstream>

namespace foci {

std::string_view sectionOf(std::string_view key) {
  const std::size_t dot = key.find('.');
  return dot == key.npos ? std::string_view() : key.substr(0, dot);
}

std::string_view leafOf(std::string_view key) { return key.substr(key.find('.') + 1); }

namespace {

/// Words that people use for what a key sets, apart by blanks: without units, and with a section
/// where they mean it only there.
struct Synonyms {
  std::string_view key, words;
};

constexpr Synonyms kSynonyms[] = {
    {"observer.pupil_mm", "aperture pupil_diameter pupil_size observer.diameter"},
    {"observer.ipd_mm", "interpupillary_distance interocular_distance eye_separation"},
    {"observer.sphere_D", "prescription spherical"},
    {"observer.cylinder_D", "astigmatism"},
    {"observer.corrected", "observer.glasses"},
    {"focus.accommodation", "observer.accommodation"},
    {"gaze.source", "gaze.file gaze.path trace recording"},
    {"gaze.time", "gaze.timestamp"},
    {"gaze.rate_Hz", "gaze.sampling_rate"},
    {"scene.file", "scene.path scene.mesh scene.model scene.points"},
    {"scene.scale_m", "scene.unit scene.units"},
    {"scene.background", "scene.colour scene.color"},
    {"eye.look_at_m", "eye.target eye.direction camera.target camera.look_at"},
    {"eye.position_m", "eye.location camera.position"},
    {"screen.size_px", "screen.resolution"},
    {"screen.size_m", "screen.width screen.height"},
    {"screen.distance_m", "viewing_distance"},
    {"screen.luminance_cd_m2", "screen.brightness"},
    {"output.size_px", "output.resolution output.width output.height"},
    {"output.fps", "framerate frame_rate frames_per_second"},
    {"output.seconds", "output.duration"},
    {"output.images", "output.frames output.png"},
    {"output.view", "output.stereo"},
    {"output.marker", "output.cursor"},
    {"focus.fixed_D", "focus.distance focus_distance focal_distance"},
    {"render.method", "render.algorithm render.mode quality.level"},
    {"quality.tolerance", "quality.error quality.max_error"},
    {"quality.frame_ms", "quality.budget"},
    {"seed", "random_seed"},
};

constexpr std::string_view kUnits[] = {"mm", "m",  "cm", "px", "deg",   "D",  "s",
                                       "ms", "Hz", "hz", "d",  "years", "um", "cd_m2"};

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
  return std::ranges::find(known, key) != known.end();
}

/// The first known key of which this holds.
template <class Holds>
std::optional<std::string> first(const std::vector<std::string>& known, const Holds& holds) {
  const auto found = std::ranges::find_if(known, holds);
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
  for (const auto& [key, words] : kSynonyms) {
    std::istringstream each{std::string(words)};
    for (std::string word; each >> word;) {
      const bool section_fits = sectionOf(word).empty() || sectionOf(word) == section;
      if (section_fits && leafOf(word) == stem && isKnown(known, key)) return std::string(key);
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
