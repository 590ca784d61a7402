// The words that a study file uses for the values of enums.
#pragma once

#include <array>
#include <cassert>
#include <optional>
#include <string_view>
#include <vector>

#include "app/session/session_settings.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

template <class Enum>
struct StudyWord {
  std::string_view text;
  Enum value;
};
template <class Enum>
StudyWord(std::string_view, Enum) -> StudyWord<Enum>;

/// The words of an enum, in the order in which messages list them.
template <class Enum>
inline constexpr std::array<StudyWord<Enum>, 0> kStudyWords{};

template <>
inline constexpr std::array kStudyWords<PupilModel>{
    StudyWord{"fixed", PupilModel::fixed},
    StudyWord{"recording", PupilModel::recording},
    StudyWord{"luminance", PupilModel::luminance},
};

template <>
inline constexpr std::array kStudyWords<DisplayKind>{
    StudyWord{"screen", DisplayKind::screen},
    StudyWord{"headset", DisplayKind::headset},
};

/// Absent: neither, which a recording with head poses refuses.
template <>
inline constexpr std::array kStudyWords<std::optional<SightFrame>>{
    StudyWord<std::optional<SightFrame>>{"unknown", std::nullopt},
    StudyWord<std::optional<SightFrame>>{"head", SightFrame::head},
    StudyWord<std::optional<SightFrame>>{"world", SightFrame::world},
};

template <>
inline constexpr std::array kStudyWords<AngleUnit>{
    StudyWord{"deg", AngleUnit::deg},
    StudyWord{"rad", AngleUnit::rad},
};

template <>
inline constexpr std::array kStudyWords<FrameMap>{
    StudyWord{"light", FrameMap::light},
    StudyWord{"depth", FrameMap::depth},
    StudyWord{"defocus", FrameMap::defocus},
};

template <>
inline constexpr std::array kStudyWords<StereoView>{
    StudyWord{"mono", StereoView::mono},
    StudyWord{"side-by-side", StereoView::side_by_side},
    StudyWord{"top-bottom", StereoView::top_bottom},
    StudyWord{"anaglyph", StereoView::anaglyph},
    StudyWord{"left", StereoView::left},
    StudyWord{"right", StereoView::right},
};

template <>
inline constexpr std::array kStudyWords<RenderDevice>{
    StudyWord{"auto", RenderDevice::automatic},
    StudyWord{"gpu", RenderDevice::gpu},
    StudyWord{"cpu", RenderDevice::cpu},
};

template <>
inline constexpr std::array kStudyWords<Detector>{
    StudyWord{nameOf(Detector::trained), Detector::trained},
    StudyWord{nameOf(Detector::rules), Detector::rules},
    StudyWord{nameOf(Detector::ivt), Detector::ivt},
    StudyWord{nameOf(Detector::idt), Detector::idt},
};

/// Absent: the file says so itself.
template <>
inline constexpr std::array kStudyWords<std::optional<GazeUnits>>{
    StudyWord<std::optional<GazeUnits>>{"auto", std::nullopt},
    StudyWord<std::optional<GazeUnits>>{"px", GazeUnits::px},
    StudyWord<std::optional<GazeUnits>>{"deg", GazeUnits::deg},
    StudyWord<std::optional<GazeUnits>>{"normalised", GazeUnits::normalised},
    StudyWord<std::optional<GazeUnits>>{"relative", GazeUnits::relative},
};

template <class Enum>
concept HasStudyWords = !kStudyWords<Enum>.empty();

template <HasStudyWords Enum>
std::vector<std::string_view> studyWords() {
  std::vector<std::string_view> words;
  words.reserve(kStudyWords<Enum>.size());
  for (const auto& word : kStudyWords<Enum>) words.push_back(word.text);
  return words;
}

template <HasStudyWords Enum>
std::string_view studyWord(const Enum& value) {
  for (const auto& word : kStudyWords<Enum>) {
    if (word.value == value) return word.text;
  }
  assert(false);
  return {};
}

}  // namespace foci
