// The quality levels of method `auto`, and how files and the command line name them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace foci {

/// How closely method `auto` renders a frame. quality_level_table.h holds the settings and the
/// measured error of each level.
enum class QualityLevel : std::uint8_t {
  // The tolerance chooses from these, from the cheapest on.
  sharp,           ///< no blur at all
  coarse,          ///< a whole-aperture pass over a coarse LOD cut
  whole_aperture,  ///< a whole-aperture pass over a finer LOD cut
  sub_apertures,   ///< 7 sub-apertures where surfaces overlap, the LOD cut of `whole_aperture`
  fine,            ///< 7 sub-apertures where surfaces overlap, the LOD cut of `sweep-lod`
  // The frame-time budget falls back to these, from the best on.
  post_filtered,  ///< the view's sharp image, blurred afterwards (blur_pyramid.h)
  soft,           ///< everything low-passed, from very few nodes
  softest,        ///< the same with twice the low-pass
  // The best, where none of the first ones meets the tolerance.
  views,  ///< the mean of pinhole views through points of the lens
};

inline constexpr std::size_t kQualityLevels = 9;

/// The levels that the tolerance chooses from, from the cheapest to the best.
inline constexpr std::array kToleranceLevels{
    QualityLevel::sharp,         QualityLevel::coarse, QualityLevel::whole_aperture,
    QualityLevel::sub_apertures, QualityLevel::fine,   QualityLevel::views};

/// The method that renders at these levels, as files and the command line name it.
inline constexpr std::string_view kAutoMethod = "auto";

/// Level N of `auto:N`, from 1; nothing for other numbers.
std::optional<QualityLevel> qualityLevelNumbered(int n);

/// The text of a level: "auto:N".
std::string textOf(QualityLevel level);

/// The level that `method` forces; nothing where it is not the text of a level.
std::optional<QualityLevel> qualityLevelFrom(std::string_view method);

}  // namespace foci
