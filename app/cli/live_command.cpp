#include "app/cli/live_command.h"

#include <nlohmann/json.hpp>

#include "app/record/manifest.h"
#include "app/record/tables.h"
#include "base/text.h"

namespace foci {

std::string liveSummaryJson(const LiveSummary& summary) {
  nlohmann::ordered_json json = {
      {"frames", summary.frames},
      {"repeated", summary.repeated},
      {"dropped", summary.dropped},
      {"first_frame_s", summary.first_frame_s},
      {"sample_to_swap_ms_median", summary.sample_to_swap.quantile_ms(0.5)},
      {"sample_to_swap_ms_p95", summary.sample_to_swap.quantile_ms(0.95)},
      {"render_ms_median", summary.render.quantile_ms(0.5)},
      {"render_ms_p95", summary.render.quantile_ms(0.95)}};
  json.update(landingsJson(summary.landings));
  json["records"] = nlohmann::ordered_json::array();
  for (const auto& folder : summary.records) json["records"].push_back(folder.string());
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string liveSummaryText(const LiveSummary& summary) {
  std::string text = std::to_string(summary.frames) + " frames, the first after " +
                     decimal(summary.first_frame_s, 2) + " s; " + std::to_string(summary.repeated) +
                     " refreshes showed an older one, " + std::to_string(summary.dropped) +
                     " were never shown\ngaze to screen " +
                     decimal(summary.sample_to_swap.quantile_ms(0.5), 1) +
                     " ms (median; 95 %: " + decimal(summary.sample_to_swap.quantile_ms(0.95), 1) +
                     " ms), drawing " + decimal(summary.render.quantile_ms(0.5), 1) +
                     " ms (95 %: " + decimal(summary.render.quantile_ms(0.95), 1) + " ms)";
  if (const Landings& landings = summary.landings; landings.count() > 0) {
    text +=
        "\nfull quality after " + std::to_string(landings.toFull().count()) + " of " +
        std::to_string(landings.count()) + " saccades, " +
        decimal(landings.toFull().quantile_ms(0.5), 0) +
        " ms after the landing (median; 95 %: " + decimal(landings.toFull().quantile_ms(0.95), 0) +
        " ms); of all frames in " + decimal(100.0 * landings.fullShare(), 0) + " %";
  }
  for (const auto& folder : summary.records) {
    text += "\nrecord: foci replay " + (folder / "study.toml").string() + " --out " +
            (folder / "replay").string();
  }
  return text;
}

}  // namespace foci
