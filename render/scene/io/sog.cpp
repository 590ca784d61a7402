// A SOG by itself, as a ZIP archive (`.sog`) or in a folder: see sog_reader.h. Streamed SOG
// (developer.playcanvas.com, The Streamed SOG Format): lod-meta.json has a tree of boxes, each of
// which names parts of chunks, one for each level of detail; a chunk is a SOG.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <glm/glm.hpp>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/sog_reader.h"

namespace foci {
namespace {

/// Whether an archive has a member of this name, or a JSON file all these words. Other scenes are
/// ZIP archives or JSON, too. A damaged archive has the name before one of its members.
bool holdsWords(const std::filesystem::path& path, std::string_view member, std::uint64_t max_json,
                std::initializer_list<std::string_view> words) {
  const std::vector<unsigned char> first = firstBytes(path, 4);
  const bool is_archive = sog::Source::isArchive(first);
  std::error_code error;
  if (!is_archive && (first.empty() || first[0] != '{')) return false;
  if (!is_archive && std::filesystem::file_size(path, error) > max_json) return false;
  const FileBytes bytes(path);
  const auto all = bytes.all();
  const auto holds = [&](std::string_view word) {
    return std::search(all.begin(), all.end(), word.begin(), word.end()) != all.end();
  };
  return is_archive ? holds(member) : std::ranges::all_of(words, holds);
}

void append(GaussianFile& to, const GaussianFile& part) {
  if (to.cloud.empty()) {
    to.cloud.degree = part.cloud.degree;
    to.cloud.preserves_light = part.cloud.preserves_light;
    to.remarks = part.remarks;
  }
  append(to.cloud, part.cloud);
  to.dropped += part.dropped;
}

}  // namespace

bool isStreamedSog(const std::filesystem::path& path) {
  return holdsWords(path, sog::kStreamMeta, sog::kMaxStreamMeta,
                    {"\"lodLevels\"", "\"filenames\""});
}

bool isSogFile(const std::filesystem::path& path) {
  return holdsWords(path, sog::kMeta, sog::kMaxMeta, {"\"means\"", "\"quats\"", "\"sh0\""});
}

GaussianFile readSogFile(const std::filesystem::path& path) {
  const sog::Source source(path);
  try {
    sog::Reader reader(source, "", source.main(sog::kMeta, sog::kMaxMeta));
    GaussianFile file{.format = "SOG"};
    file.cloud.degree = reader.degree();
    reader.appendTo(file, std::array{sog::Range{0, reader.count()}});
    finishGaussians(file, source.name());
    return file;
  } catch (const sog::Json::exception&) {
    throw InputError(source.name(), std::string(sog::kMeta),
                     ": expected the JSON of a SOG of version 1 or 2");
  }
}

struct StreamedGaussians::Content {
  /// A box of a streamed scene: parts of chunks, by level of detail; the finest first.
  struct Leaf {
    glm::vec3 low{0.0f}, high{0.0f};
    struct Level {
      std::size_t chunk = 0;
      sog::Range range;
    };
    std::vector<std::optional<Level>> levels;

    /// Distance of the Gaussians of a level, as if they lay on the box's faces.
    float spacing(const Level& level) const {
      const glm::vec3 s = high - low;
      const float area = 2.0f * (s.x * s.y + s.y * s.z + s.z * s.x);
      return std::sqrt(area / static_cast<float>(std::max<std::size_t>(level.range.count, 1)));
    }

    /// The coarsest level that is fine enough, or the finest there is; null without any.
    const Level* chosen(float spacing_needed) const {
      const Level* finest = nullptr;
      for (std::size_t i = levels.size(); i-- > 0;) {
        if (!levels[i]) continue;
        finest = &*levels[i];
        if (spacing(*finest) <= spacing_needed) break;
      }
      return finest;
    }
  };

  explicit Content(const std::filesystem::path& path) : source(path) {
    const std::vector<unsigned char> text = source.main(sog::kStreamMeta, sog::kMaxStreamMeta);
    const sog::Json meta = sog::Json::parse(text.begin(), text.end());
    const std::int64_t version = meta.value("version", std::int64_t{1});
    if (version > 1) {
      throw InputError(source.name(), "is streamed SOG of version ", version,
                       ": expected version 1");
    }
    chunks = meta.at("filenames").get<std::vector<std::string>>();
    levels = meta.at("lodLevels").get<std::size_t>();
    constexpr std::size_t kMostLevels = 64;
    if (levels < 1 || levels > kMostLevels) {
      throw InputError(source.name(), "has ", levels, " levels: expected 1 to 64");
    }
    if (const auto found = meta.find("environment"); found != meta.end() && found->is_string()) {
      environment = found->get<std::string>();
    }
    addLeaves(meta.at("tree"));
    if (leaves.empty()) throw InputError(source.name(), "has no Gaussians");
  }

  void addLeaves(const sog::Json& root) {
    std::vector<const sog::Json*> rest = {&root};
    while (!rest.empty()) {
      const sog::Json& node = *rest.back();
      rest.pop_back();
      if (const auto children = node.find("children"); children != node.end()) {
        for (std::size_t i = children->size(); i-- > 0;) rest.push_back(&children->at(i));
      }
      if (const auto lods = node.find("lods"); lods != node.end()) addLeaf(node, *lods);
    }
  }

  void addLeaf(const sog::Json& node, const sog::Json& lods) {
    Leaf leaf;
    const auto corner = [&](const char* which) {
      const auto p = node.at("bound").at(which).get<std::array<float, 3>>();
      return glm::vec3(p[0], p[1], p[2]);
    };
    leaf.low = corner("min");
    leaf.high = corner("max");
    leaf.levels.resize(levels);
    for (std::size_t level = 0; level < levels; ++level) {
      const auto found = lods.find(std::to_string(level));
      if (found == lods.end()) continue;
      const Leaf::Level part{
          found->at("file").get<std::size_t>(),
          {found->at("offset").get<std::size_t>(), found->at("count").get<std::size_t>()}};
      if (part.chunk >= chunks.size() || part.range.count > kMostGaussians) {
        throw InputError(source.name(), std::string(sog::kStreamMeta),
                         ": a box names a chunk that is not there, or too many Gaussians");
      }
      leaf.levels[level] = part;
    }
    const Leaf::Level* const finest = leaf.chosen(0.0f);
    if (finest == nullptr) return;
    count += finest->range.count;
    leaves.push_back(std::move(leaf));
  }

  /// The parts of each chunk that are needed, in order.
  std::vector<std::vector<sog::Range>> rangesFor(const Fineness& fineness, float factor) const {
    std::vector<std::vector<sog::Range>> ranges(chunks.size());
    for (const Leaf& leaf : leaves) {
      const float needed = fineness ? factor * fineness(leaf.low, leaf.high) : 0.0f;
      const Leaf::Level* const level = leaf.chosen(needed);
      ranges[level->chunk].push_back(level->range);
    }
    return ranges;
  }

  static constexpr std::size_t kMostGaussians = std::size_t{1} << 32u;
  sog::Source source;
  std::vector<std::string> chunks;
  std::string environment;
  std::vector<Leaf> leaves;
  std::size_t levels = 1, count = 0;
};

StreamedGaussians::StreamedGaussians(const std::filesystem::path& path) {
  try {
    content_ = std::make_shared<const Content>(path);
  } catch (const sog::Json::exception&) {
    throw InputError(path.string(), std::string(sog::kStreamMeta),
                     ": expected the JSON of a streamed SOG of version 1");
  }
}

std::size_t StreamedGaussians::size() const { return content_->count; }

std::vector<glm::vec3> StreamedGaussians::corners() const {
  std::vector<glm::vec3> corners;
  for (const Content::Leaf& leaf : content_->leaves) {
    for (int i = 0; i < 8; ++i) {
      corners.emplace_back((i & 1) != 0 ? leaf.high.x : leaf.low.x,
                           (i & 2) != 0 ? leaf.high.y : leaf.low.y,
                           (i & 4) != 0 ? leaf.high.z : leaf.low.z);
    }
  }
  return corners;
}

GaussianFile StreamedGaussians::read(const Fineness& fineness) const {
  const Content& content = *content_;
  const auto counted = [](const std::vector<std::vector<sog::Range>>& ranges) {
    std::size_t count = 0;
    for (const auto& chunk : ranges) {
      for (const sog::Range& range : chunk) count += range.count;
    }
    return count;
  };
  // As fine as needed, or as the memory of a first frame allows.
  constexpr float kCoarser = 1.4f, kCoarsest = 1e6f;
  auto ranges = content.rangesFor(fineness, 1.0f);
  for (float factor = kCoarser; fineness && counted(ranges) > kMostStreamed && factor < kCoarsest;
       factor *= kCoarser) {
    ranges = content.rangesFor(fineness, factor);
  }
  struct Part {
    std::string folder;
    std::vector<sog::Range> ranges;
    std::optional<sog::Reader> reader;
    GaussianFile file;
  };
  std::vector<Part> parts;
  const auto add = [&](const std::string& meta, std::vector<sog::Range> of) {
    parts.push_back({meta.substr(0, meta.rfind('/') + 1), std::move(of), {}, {}});
    parts.back().reader.emplace(content.source, parts.back().folder,
                                content.source.read(meta, sog::kMaxMeta));
  };
  try {
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      if (!ranges[i].empty()) add(content.chunks[i], std::move(ranges[i]));
    }
    if (!content.environment.empty()) {
      add(content.environment, {});
      parts.back().ranges = {{0, parts.back().reader->count()}};
    }
    int degree = 0;
    for (const Part& part : parts) degree = std::max(degree, part.reader->degree());
    parallelFor(parts.size(), [&](std::size_t i) {
      parts[i].file.cloud.degree = degree;
      parts[i].reader->appendTo(parts[i].file, parts[i].ranges);
      parts[i].reader.reset();
    });
  } catch (const sog::Json::exception&) {
    throw InputError(content.source.name(), "a chunk's meta.json: expected the JSON of a SOG");
  }
  GaussianFile file{.format = "streamed SOG"};
  for (Part& part : parts) {
    append(file, part.file);
    part.file = {};
  }
  finishGaussians(file, content.source.name());
  if (file.cloud.size() < content.count) {
    file.remarks.push_back(thousands(static_cast<double>(file.cloud.size())) + " of its " +
                           thousands(static_cast<double>(content.count)) +
                           " Gaussians are read: as fine as the view needs, or memory allows");
  }
  return file;
}

}  // namespace foci
