#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "app/evaluation/chart/cases.h"
#include "app/evaluation/chart/chart.h"
#include "app/evaluation/evaluation_page.h"
#include "app/platform/json_text.h"
#include "base/file.h"
#include "base/input_error.h"
#include "base/nearest.h"
#include "base/text.h"
#include "render/methods/method.h"

namespace foci {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kMaxJsonBytes = std::uintmax_t{1} << 24;
constexpr std::size_t kMaxRendererName = 40, kMaxListedText = 200;  // characters

Json readJson(const fs::path& file, const std::string& expected) {
  Json json = Json::parse(bytesOfFile(file, kMaxJsonBytes), nullptr, false);
  if (json.is_discarded()) throw InputError(file.string(), "is no JSON: expected ", expected);
  return json;
}

/// An entry of times.json.
struct ListedImage {
  std::string where{};  ///< for messages
  std::string name{}, version{}, machine{}, case_name{}, image{}, sharp{};
  double ms = 0.0;
};

ListedImage listedImage(const Json& json, const std::string& where) {
  ListedImage entry{.where = where};
  const std::vector<std::pair<const char*, std::string*>> texts = {
      {"name", &entry.name},      {"version", &entry.version}, {"machine", &entry.machine},
      {"case", &entry.case_name}, {"image", &entry.image},     {"sharp", &entry.sharp}};
  if (!json.is_object()) throw InputError(where, "expected an object in braces");
  for (const auto& [key, value] : json.items()) {
    const bool known = key == "ms" || std::ranges::count(texts, key, [](const auto& text) {
                                        return std::string_view(text.first);
                                      }) > 0;
    if (!known) {
      throw InputError(where, shown(key),
                       ": expected name, version, machine, ms, case, image and sharp");
    }
  }
  for (const auto& [key, text] : texts) {
    if (!json.contains(key) || !json[key].is_string() || json[key].get<std::string>().empty() ||
        json[key].get<std::string>().size() > kMaxListedText) {
      throw InputError(where, key, ": expected a text of 1 to ", kMaxListedText, " characters");
    }
    *text = json[key].get<std::string>();
  }
  const bool plain = std::ranges::all_of(entry.name, [](unsigned char c) {
    return (std::isalnum(c) != 0 && c < 128) || c == '.' || c == '-' || c == '_' || c == ':';
  });
  if (!plain || entry.name.size() > kMaxRendererName) {
    throw InputError(where, "name ", shown(entry.name), ": expected letters, digits and . - _ :, ",
                     kMaxRendererName, " at most");
  }
  if (!expectedMethod(entry.name)) {
    throw InputError(where, "name ", shown(entry.name), " is a method of foci's");
  }
  if (!json.contains("ms") || !json["ms"].is_number() || !(json["ms"].get<double>() > 0.0) ||
      !(json["ms"].get<double>() < 1e9)) {
    throw InputError(where, "ms: expected milliseconds, above 0 and below 1e9");
  }
  entry.ms = json["ms"].get<double>();
  return entry;
}

/// An exported case, with the frames that images are compared with.
class ImportedCase {
 public:
  ImportedCase(const ImportedCase&) = delete;  // `compared` points into it
  ImportedCase& operator=(const ImportedCase&) = delete;

  /// @param key  of the plan: another one is refused
  ImportedCase(const fs::path& folder, const std::string& name, const std::string& key)
      : folder_(folder) {
    const fs::path file = folder / name / "case.json";
    const Json json = readJson(file, "a case that foci exported");
    Defocus lens{.along = DistanceAlong::axis};
    std::string exported;
    try {
      exported = json.at("key").get<std::string>();
      lens.radius_px_per_D = glm::vec2(json.at("lens").at("blur_radius_px_per_D").get<float>());
      lens.focus_D = static_cast<float>(1.0 / json.at("lens").at("focus_m").get<double>());
      psnr_dB = numberInJson(json.at("reference").at("split_half_psnr_dB"));
    } catch (const Json::exception&) {
      throw InputError(file.string(), "expected a case that foci exported");
    }
    if (exported != key) {
      throw InputError(file.string(),
                       "was exported with other options than those of this chart (its README.md)");
    }
    reference = readImage(folder / name / "reference.exr");
    const fs::path scene = (folder / name).parent_path();
    sharp_ = imageOf(scene / "sharp.exr");
    const Frame depth = imageOf(scene / "depth.exr");
    for (std::size_t i = 0; i < depth.rgba.size(); ++i) {
      sharp_.depth_m.push_back(depth.rgba[i].r);
      sharp_.rgba[i].a = depth.rgba[i].r > 0.0f ? 1.0f : 0.0f;
    }
    compared = comparedWith(reference, sharp_, lens);
  }

  /// The image of an entry, whose sharp image shows the same view.
  Frame frameOf(const ListedImage& entry) const {
    const std::string fault = cameraFault(imageOf(folder_ / entry.sharp), sharp_);
    if (!fault.empty()) throw InputError((folder_ / entry.sharp).string(), fault);
    return imageOf(folder_ / entry.image);
  }

  double psnr_dB = 0.0;  ///< of the reference
  Frame reference{};
  Compared compared{};

 private:
  /// An image as large as the reference.
  Frame imageOf(const fs::path& file) const {
    Frame frame = readImage(file);
    if (frame.size_px == reference.size_px) return frame;
    throw InputError(file.string(), "has ", frame.size_px.x, " x ", frame.size_px.y,
                     " px: expected ", reference.size_px.x, " x ", reference.size_px.y);
  }

  fs::path folder_;
  Frame sharp_{};
};

void requireKnownCases(const std::vector<ListedImage>& entries, const ChartPlan& plan) {
  std::vector<std::string> known;
  for (const ChartScene& scene : plan.scenes) {
    for (const double blur_px : plan.blurs_px) known.push_back(caseName(scene, blur_px));
  }
  for (const ListedImage& entry : entries) {
    if (std::ranges::find(known, entry.case_name) != known.end()) continue;
    throw InputError(entry.where, "case ", shown(entry.case_name),
                     " is none of this chart: the nearest is ", nearest(entry.case_name, known));
  }
}

}  // namespace

std::vector<ImportedPoint> importPoints(const ChartPlan& plan, const fs::path& folder) {
  const fs::path file = folder / "times.json";
  const Json json = readJson(file, "a list of images");
  if (!json.is_array() || json.empty()) {
    throw InputError(file.string(), "expected a list of images that is not empty");
  }
  std::vector<ListedImage> entries;
  std::set<std::pair<std::string, std::string>> seen;
  for (const Json& one : json) {
    const std::string where = file.string() + ": entry " + std::to_string(entries.size() + 1);
    entries.push_back(listedImage(one, where));
    const EvaluatedMethod renderer{entries.back().name, std::nullopt};
    if (!seen.insert({entries.back().case_name, renderer.fileName()}).second) {
      throw InputError(where, "a second image of ", shown(entries.back().case_name), " by ",
                       shown(entries.back().name));
    }
  }
  requireKnownCases(entries, plan);
  std::vector<ImportedPoint> imported;
  for (const ChartScene& scene : plan.scenes) {
    for (const double blur_px : plan.blurs_px) {
      const std::string name = caseName(scene, blur_px);
      std::optional<ImportedCase> of;
      for (const ListedImage& entry : entries) {
        if (entry.case_name != name) continue;
        if (!of) of.emplace(folder, name, plan.key(scene, blur_px));
        const Frame frame = of->frameOf(entry);
        imported.push_back({.point = {scoresOf(frame, of->compared)},
                            .image = imageOf(frame),
                            .difference = differenceOf(frame, of->reference, kDifferenceGain),
                            .read = {folder / entry.image, folder / entry.sharp}});
        ChartPoint& point = imported.back().point;
        point.scene = scene.id;
        point.blur_px = blur_px;
        point.method = {entry.name, std::nullopt};
        point.renderer = entry.version + ", " + entry.machine;
        point.threads = plan.threads.back();
        point.ms_median = point.ms_min = entry.ms;
        point.coverage_error.reset();  // images of others have no coverage
        point.reference_psnr_dB = of->psnr_dB;
      }
    }
  }
  return imported;
}

std::vector<fs::path> importedFiles(const std::vector<ImportedPoint>& points,
                                    const fs::path& folder) {
  std::vector<fs::path> files;
  for (const ImportedPoint& one : points) {
    const std::string image = imageFile(one.point);
    files.push_back(folder / image);
    files.push_back(folder / differenceFileOf(image));
  }
  return files;
}

void writeImages(const std::vector<ImportedPoint>& points, OutputFolder& output) {
  for (const ImportedPoint& one : points) {
    const std::string image = imageFile(one.point);
    output.write(image, pngOf(one.image));
    output.write(differenceFileOf(image), pngOf(one.difference));
  }
}

}  // namespace foci
