// The quality levels of method `auto`, how files and the command line name them, and which of them
// a frame-time budget allows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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
  thorough,  ///< many sub-apertures over the whole image
};

inline constexpr std::size_t kQualityLevels = 9;

/// The levels that the tolerance chooses from, from the cheapest to the best.
inline constexpr std::array kToleranceLevels{
    QualityLevel::sharp,         QualityLevel::coarse, QualityLevel::whole_aperture,
    QualityLevel::sub_apertures, QualityLevel::fine,   QualityLevel::thorough};

/// The method that renders at these levels, as files and the command line name it.
inline constexpr std::string_view kAutoMethod = "auto";

/// Level N of `auto:N`, from 1; nothing for other numbers.
std::optional<QualityLevel> qualityLevelNumbered(int n);

/// The text of a level: "auto:N".
std::string textOf(QualityLevel level);

/// The level that `method` forces; nothing where it is not the text of a level.
std::optional<QualityLevel> qualityLevelFrom(std::string_view method);

/// Whether the method chooses a quality level for each frame itself. Its small errors are allowed,
/// so frames that change too little to see are reused.
inline bool choosesQuality(std::string_view method) { return method == kAutoMethod; }

/// Whether the method takes notice of `Quality`: `auto`, or `auto:N` with a forced quality level.
inline bool usesQuality(std::string_view method) {
  return choosesQuality(method) || qualityLevelFrom(method).has_value();
}

/// How long each level takes, learnt from the frames that it rendered: to meet a frame-time budget,
/// the time must be known before the frame is rendered.
class TimeBudget {
 public:
  /// @param relative  times of the levels in any unit: the first guess of one from another
  /// @param hopeful   while nothing has been timed, every level is expected to fit: a GPU is fast
  explicit TimeBudget(std::span<const float> relative, bool hopeful = false);

  /// The time that a level is expected to take. While nothing has been timed, infinite, or 0 for
  /// the hopeful.
  float expected_ms(QualityLevel level) const;

  /// Whether the level is expected to meet the budget. The level of the last frame may use all of
  /// it; other levels need a reserve, so that the level does not flicker.
  bool fits(QualityLevel level, float budget_ms) const;

  /// Records the time of a frame. The times of the other levels decay, so that these levels are
  /// tried again. They decay faster where the view has `moved`, because its cost has changed too.
  void took(QualityLevel level, float ms, bool moved);

 private:
  struct Timing {
    float relative = 1.0f;
    float ms = 0.0f;  // 0: never timed
  };
  Timing& of(QualityLevel level) { return timings_[static_cast<std::size_t>(level)]; }
  const Timing& of(QualityLevel level) const { return timings_[static_cast<std::size_t>(level)]; }

  std::vector<Timing> timings_;
  std::optional<QualityLevel> last_;
  bool hopeful_;
};

}  // namespace foci
