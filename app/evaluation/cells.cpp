#include "app/evaluation/cells.h"

#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "app/platform/json_text.h"
#include "app/platform/machine.h"
#include "app/platform/output_files.h"
#include "app/platform/sha256.h"

namespace foci {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::optional<std::string> contentOf(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::nullopt;
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  return std::string{std::istreambuf_iterator<char>(in), {}};
}

/// The content of a file with this key, as `parse` reads it.
template <typename Parse>
auto parsed(const fs::path& file, const std::string& key, const Parse& parse)
    -> std::optional<decltype(parse(Json()))> {
  const auto text = contentOf(file);
  if (!text) return std::nullopt;
  try {
    Json json = Json::parse(*text);
    const auto sha256 = json.at("own_sha256").get<std::string>();
    json.erase("own_sha256");
    if (json.at("key") != key || sha256Of(json.dump()) != sha256) return std::nullopt;
    return parse(json);
  } catch (const Json::exception&) {
    return std::nullopt;  // another program wrote the file, or it is not complete
  }
}

std::string textOf(Json json) {
  json["own_sha256"] = sha256Of(json.dump());
  return json.dump(1) + "\n";
}

}  // namespace

std::string programKey() {
  const Machine machine = describeMachine();
  return "program " + sha256OfFile(programFile()) + "; " + machine.cpu + ", " +
         std::to_string(machine.cores) + " cores, " + machine.simd + "; ";
}

ChartCells::ChartCells(fs::path folder, std::string key, OutputGuard guard)
    : folder_(std::move(folder)), key_(std::move(key)), guard_(std::move(guard)) {}

std::optional<ChartCell> ChartCells::load(const std::string& name, const std::string& key) const {
  return parsed(folder_ / (name + ".json"), key_ + key, [](const Json& json) {
    ChartCell cell{.psnr_dB = numberInJson(json.at("psnr_dB")),
                   .ssim = json.at("ssim"),
                   .coverage_error = json.at("coverage_error"),
                   .visible_error = json.at("visible_error"),
                   .flip = json.at("flip"),
                   .first_ms = json.at("first_ms")};
    const Json& silhouette = json.at("silhouette_psnr_dB");
    if (!silhouette.is_null()) cell.silhouette_psnr_dB = numberInJson(silhouette);
    json.at("expected_error").get_to(cell.expected_error);
    json.at("tolerance_met").get_to(cell.tolerance_met);
    const Json& level = json.at("quality_level");
    if (!level.is_null()) cell.quality_level = qualityLevelFrom(level.get<std::string>());
    for (const auto& [threads, ms] : json.at("ms").items()) {
      cell.ms[static_cast<unsigned>(std::atoi(threads.c_str()))] = ms.get<std::vector<double>>();
    }
    return cell;
  });
}

void ChartCells::store(const std::string& name, const std::string& key,
                       const ChartCell& cell) const {
  Json json = {{"key", key_ + key},
               {"psnr_dB", jsonNumber(cell.psnr_dB)},
               {"ssim", cell.ssim},
               {"silhouette_psnr_dB", nullptr},
               {"coverage_error", cell.coverage_error},
               {"visible_error", cell.visible_error},
               {"flip", cell.flip},
               {"expected_error", cell.expected_error},
               {"tolerance_met", cell.tolerance_met},
               {"quality_level", nullptr},
               {"first_ms", cell.first_ms},
               {"ms", Json::object()}};
  if (cell.silhouette_psnr_dB) json["silhouette_psnr_dB"] = jsonNumber(*cell.silhouette_psnr_dB);
  if (cell.quality_level) json["quality_level"] = textOf(*cell.quality_level);
  for (const auto& [threads, ms] : cell.ms) json["ms"][std::to_string(threads)] = ms;
  writeOutput(folder_ / (name + ".json"), textOf(json), guard_);
}

std::optional<ChartCells::Lists> ChartCells::loadLists(const std::string& name,
                                                       const std::string& key) const {
  return parsed(folder_ / (name + ".json"), key_ + key,
                [](const Json& json) { return json.at("lists").get<Lists>(); });
}

void ChartCells::storeLists(const std::string& name, const std::string& key,
                            const Lists& lists) const {
  const Json json = {{"key", key_ + key}, {"lists", lists}};
  writeOutput(folder_ / (name + ".json"), textOf(json), guard_);
}

std::optional<ChartReference> ChartCells::loadReferenceFigures(const std::string& name,
                                                               const std::string& key) const {
  return parsed(folder_ / (name + ".json"), key_ + key, [](const Json& json) {
    return ChartReference{
        .views = json.at("views"),
        .split_half_psnr_dB = numberInJson(json.at("split_half_psnr_dB")),
        .frame = {
            .size_px = {json.at("width_px"), json.at("height_px")}, .rgba = {}, .depth_m = {}}};
  });
}

std::optional<ChartReference> ChartCells::loadReference(const std::string& name,
                                                        const std::string& key) const {
  auto reference = loadReferenceFigures(name, key);
  const auto bytes = contentOf(folder_ / (name + ".rgba"));
  const auto sha256 = parsed(folder_ / (name + ".json"), key_ + key,
                             [](const Json& json) { return json.at("sha256").get<std::string>(); });
  if (!reference || !bytes || sha256 != sha256Of(*bytes)) return std::nullopt;
  Frame& frame = reference->frame;
  frame.rgba.resize(static_cast<std::size_t>(frame.size_px.x) * frame.size_px.y);
  if (bytes->size() != frame.rgba.size() * sizeof frame.rgba[0]) return std::nullopt;
  std::memcpy(frame.rgba.data(), bytes->data(), bytes->size());
  return reference;
}

void ChartCells::storeReference(const std::string& name, const std::string& key,
                                const ChartReference& reference) const {
  const Frame& frame = reference.frame;
  std::string bytes(frame.rgba.size() * sizeof frame.rgba[0], '\0');
  std::memcpy(bytes.data(), frame.rgba.data(), bytes.size());
  writeOutput(folder_ / (name + ".rgba"), bytes, guard_);
  const Json json = {{"key", key_ + key},
                     {"views", reference.views},
                     {"split_half_psnr_dB", jsonNumber(reference.split_half_psnr_dB)},
                     {"width_px", frame.size_px.x},
                     {"height_px", frame.size_px.y},
                     {"sha256", sha256Of(bytes)}};
  writeOutput(folder_ / (name + ".json"), textOf(json), guard_);
}

}  // namespace foci
