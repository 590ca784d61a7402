#include "app/record/quality_json.h"

#include <nlohmann/json.hpp>

#include "app/record/tables.h"
#include "base/text.h"

namespace foci {
namespace {

nlohmann::ordered_json orNull(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

nlohmann::ordered_json toJson(const RecordingQuality& quality) {
  nlohmann::ordered_json json = {{"rate_Hz", quality.rate_Hz},
                                 {"jitter_s", quality.jitter_s},
                                 {"lost", quality.lost},
                                 {"longest_gap_s", quality.longest_gap_s},
                                 {"rms_s2s_deg", orNull(quality.rms_s2s_deg)},
                                 {"sd_deg", orNull(quality.sd_deg)},
                                 {"unjudged", quality.unjudged},
                                 {"main_sequence", nullptr}};
  if (const auto& fit = quality.main_sequence) {
    json["main_sequence"] = {{"saccades", fit->saccades},
                             {"at_1_deg_deg_s", fit->at_1_deg_deg_s},
                             {"exponent", fit->exponent}};
  }
  return json;
}

std::string qualityText(const RecordingQuality& quality) {
  std::string text = "quality: jitter " + decimal(1e3 * quality.jitter_s, 2) + " ms, lost " +
                     decimal(100.0 * quality.lost, 1) + " %, longest gap " +
                     decimal(quality.longest_gap_s, 3) + " s, unjudged " +
                     decimal(100.0 * quality.unjudged, 1) + " %; noise in fixations: RMS-S2S " +
                     orAbsent(quality.rms_s2s_deg, 3) + " deg, SD " + orAbsent(quality.sd_deg, 3) +
                     " deg; main sequence: ";
  if (const auto& fit = quality.main_sequence) {
    return text + decimal(fit->at_1_deg_deg_s, 0) + " deg/s at 1 deg, exponent " +
           decimal(fit->exponent, 2);
  }
  return text + "n/a";
}

}  // namespace foci
