#include <tbb/global_control.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "app/cli/commands.h"
#include "app/cli/option_values.h"
#include "app/cli/scan_options.h"
#include "app/evaluation/reproduce/reproduce.h"
#include "app/platform/json_text.h"
#include "app/platform/output_files.h"
#include "base/text.h"

namespace foci {
namespace {

std::string reproduceJson(const ReproduceSummary& summary) {
  nlohmann::ordered_json ratios = nlohmann::ordered_json::array();
  for (const ReproduceRatio& one : summary.ratios) {
    nlohmann::ordered_json ratio = {{"figure", one.key},
                                    {"scene", one.scene},
                                    {"value", jsonNumber(one.value)},
                                    {one.at_most ? "at_most" : "at_least", one.wanted}};
    if (!summary.quick) ratio["reached"] = one.reached();
    ratios.push_back(std::move(ratio));
  }
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const ReproduceRow& row : summary.rows) {
    rows.push_back({{"scene", row.scene},
                    {"aperture", row.aperture_m},
                    {"method", row.method},
                    {"threads", row.threads},
                    {"kfragments", row.kfragments},
                    {"ms_median", row.ms_median},
                    {"psnr_dB", jsonNumber(row.psnr_dB)}});
  }
  nlohmann::ordered_json all = {{"out", summary.out.string()},
                                {"seconds", summary.seconds},
                                {"quick", summary.quick},
                                {"ratios", ratios},
                                {"rows", rows}};
  if (summary.growth) {
    for (const Growth::Size& size : {summary.growth->before, summary.growth->after}) {
      all["growth"].push_back({{"surfels", size.surfels},
                               {"build_s", size.build_s},
                               {"bytes_per_surfel", size.bytes_per_surfel},
                               {"ms_median", size.ms_median}});
    }
  }
  return jsonText(all);
}

struct ReproduceOptions {
  std::string out{};
  ScanOptions scan{};
  bool quick = false, json = false, overwrite = false;
};

void runReproduce(const ReproduceOptions& options) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  threadsOf(options.scan.threads));
  const OutputGuard guard(reproduceFiles(options.out), scanFiles(options.scan), options.overwrite);
  const ReproduceSummary summary = reproduce({.out = options.out,
                                              .scan = scanViewOf(options.scan),
                                              .quick = options.quick,
                                              .guard = guard});
  if (options.json) {
    std::puts(reproduceJson(summary).c_str());
    return;
  }
  for (const ReproduceRatio& one : summary.ratios) {
    std::printf("%-7s %s: %s, wanted %s %g%s\n", one.scene.c_str(), one.what.c_str(),
                std::isfinite(one.value) ? decimal(one.value, one.digits).c_str() : "exact",
                one.at_most ? "at most" : "at least", one.wanted,
                summary.quick || one.reached() ? "" : ": not reached");
  }
  if (summary.quick) std::puts("A quick run: its figures scatter too much to be judged.");
  std::printf("%.0f s; page: %s\n", summary.seconds,
              visible((summary.out / "reproduce.html").string()).c_str());
}

}  // namespace

void addReproduceCommand(CLI::App& app) {
  const auto options = std::make_shared<ReproduceOptions>();
  CLI::App* command = app.add_subcommand("reproduce",
                                         "Measure Table 1, Figure 1 and Figure 6 of the 2003 paper "
                                         "on this machine. The run takes under\n"
                                         "ten minutes and 2 GB of memory.\n"
                                         "Example: foci reproduce --out out/paper");
  addOption(*command, "--out", options->out, "DIR", "folder of the results")->required();
  command->add_flag(
      "--quick", options->quick,
      "one minute: fewer repetitions, a coarse reference, no scene of 10 million surfels; shows "
      "the figures without judging them");
  addScanOptions(*command, options->scan);
  addOverwriteFlag(*command, options->overwrite);
  command->add_flag("--json", options->json, "print the figures as JSON");
  onceParsed(*command, [options] { runReproduce(*options); });
}

}  // namespace foci
