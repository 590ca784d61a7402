// The words that a study file uses for the values of enums.
#pragma once

#include <array>
#include <cassert>
#include <optional>
#include <string_view>
#include <vector>

#include "app/session/session_settings.h"
#include "base/transformed.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

template <class Enum>
struct StudyWord {
  std::string_view text;
  Enum value;
};

/// The words of an enum, in the order in which messages list them.
template <class Enum>
inline constexpr std::array<StudyWord<Enum>, 0> kStudyWords{};

template <>
inline constexpr auto kStudyWords<PupilModel> =
    std::to_array<StudyWord<PupilModel>>({{"fixed", PupilModel::fixed},
                                          {"recording", PupilModel::recording},
                                          {"luminance", PupilModel::luminance}});

template <>
inline constexpr auto kStudyWords<DisplayKind> = std::to_array<StudyWord<DisplayKind>>(
    {{"screen", DisplayKind::screen}, {"headset", DisplayKind::headset}});

/// Absent: neither, which a recording with head poses refuses.
template <>
inline constexpr auto kStudyWords<std::optional<SightFrame>> =
    std::to_array<StudyWord<std::optional<SightFrame>>>({{"unknown", std::nullopt},
                                                         {"head", SightFrame::head},
                                                         {"world", SightFrame::world}});

template <>
inline constexpr auto kStudyWords<AngleUnit> =
    std::to_array<StudyWord<AngleUnit>>({{"deg", AngleUnit::deg}, {"rad", AngleUnit::rad}});

template <>
inline constexpr auto kStudyWords<FrameMap> = std::to_array<StudyWord<FrameMap>>(
    {{"light", FrameMap::light}, {"depth", FrameMap::depth}, {"defocus", FrameMap::defocus}});

template <>
inline constexpr auto kStudyWords<StereoView> =
    std::to_array<StudyWord<StereoView>>({{"mono", StereoView::mono},
                                          {"side-by-side", StereoView::side_by_side},
                                          {"top-bottom", StereoView::top_bottom},
                                          {"anaglyph", StereoView::anaglyph},
                                          {"left", StereoView::left},
                                          {"right", StereoView::right}});

template <>
inline constexpr auto kStudyWords<RenderDevice> = std::to_array<StudyWord<RenderDevice>>(
    {{"auto", RenderDevice::automatic}, {"gpu", RenderDevice::gpu}, {"cpu", RenderDevice::cpu}});

template <>
inline constexpr auto kStudyWords<Detector> =
    std::to_array<StudyWord<Detector>>({{nameOf(Detector::trained), Detector::trained},
                                        {nameOf(Detector::rules), Detector::rules},
                                        {nameOf(Detector::ivt), Detector::ivt},
                                        {nameOf(Detector::idt), Detector::idt}});

/// Absent: the file says so itself.
template <>
inline constexpr auto kStudyWords<std::optional<GazeUnits>> =
    std::to_array<StudyWord<std::optional<GazeUnits>>>({{"auto", std::nullopt},
                                                        {"px", GazeUnits::px},
                                                        {"deg", GazeUnits::deg},
                                                        {"normalised", GazeUnits::normalised},
                                                        {"relative", GazeUnits::relative}});

template <class Enum>
concept HasStudyWords = !kStudyWords<Enum>.empty();

template <HasStudyWords Enum>
std::vector<std::string_view> studyWords() {
  return transformed(kStudyWords<Enum>, [](const auto& word) { return word.text; });
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
