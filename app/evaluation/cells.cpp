#include "app/evaluation/cells.h"

#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "app/evaluation/evaluation_page.h"
#include "app/platform/json_text.h"
#include "app/platform/machine.h"
#include "app/platform/output_files.h"
#include "app/platform/sha256.h"
#include "base/parallel.h"

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

/// Calls `field` with the name and the value of what JSON has as it is.
template <class Cell, class Field>
void eachField(Cell& cell, const Field& field) {
  field("ssim", cell.errors.ssim);
  field("coverage_error", cell.errors.coverage_error);
  field("visible_error", cell.errors.visible_error);
  field("flip", cell.errors.flip);
  field("expected_error", cell.errors.expected_error);
  field("tolerance_met", cell.errors.tolerance_met);
  field("first_ms", cell.first_ms);
  field("ms", cell.ms);
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

ChartCells::ChartCells(fs::path chart, std::string key, OutputGuard guard)
    : chart_(std::move(chart)),
      folder_(chart_ / "cells"),
      key_(std::move(key)),
      guard_(std::move(guard)) {}

bool ChartCells::hasImage(const std::string& name) const {
  std::error_code ignored;
  return fs::exists(chart_ / name, ignored);
}

void ChartCells::writeImage(const std::string& name, const Image& image) const {
  writeOutput(chart_ / name, pngOf(image), guard_);
}

void ChartCells::writeImages(const std::string& name, const Frame& frame,
                             const Frame& reference) const {
  parallelFor(2, [&](std::size_t i) {
    if (i == 0) writeImage(name, imageOf(frame));
    if (i == 1) writeImage(differenceFileOf(name), differenceOf(frame, reference, kDifferenceGain));
  });
}

std::optional<ChartCell> ChartCells::load(const std::string& name, const std::string& key) const {
  return parsed(folder_ / (name + ".json"), key_ + key, [](const Json& json) {
    ChartCell cell;
    eachField(cell, [&](const char* field, auto& value) { json.at(field).get_to(value); });
    cell.errors.psnr_dB = numberInJson(json.at("psnr_dB"));
    const Json& silhouette = json.at("silhouette_psnr_dB");
    if (!silhouette.is_null()) cell.errors.silhouette_psnr_dB = numberInJson(silhouette);
    const Json& level = json.at("quality_level");
    if (!level.is_null()) cell.errors.quality_level = qualityLevelFrom(level.get<std::string>());
    return cell;
  });
}

void ChartCells::store(const std::string& name, const std::string& key,
                       const ChartCell& cell) const {
  const ChartErrors& errors = cell.errors;
  Json json = {{"key", key_ + key},
               {"psnr_dB", jsonNumber(errors.psnr_dB)},
               {"silhouette_psnr_dB", nullptr},
               {"quality_level", nullptr}};
  eachField(cell, [&](const char* field, const auto& value) { json[field] = value; });
  if (const auto& dB = errors.silhouette_psnr_dB) json["silhouette_psnr_dB"] = jsonNumber(*dB);
  if (errors.quality_level) json["quality_level"] = textOf(*errors.quality_level);
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
