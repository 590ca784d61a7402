// mkkellogg's `.ksplat` (GaussianSplats3D): see gaussian_formats.h. A header of 4096 bytes, a
// header of 1024 bytes for each section, and the sections: the lengths of buckets that are not
// full, the centres of all buckets, and the Gaussians. Mode 0 stores floats. Modes 1 and 2 store
// positions in 16 bits from the bucket's centre, and the rest in half floats; mode 2 stores
// harmonics in bytes.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/packing.hpp>
#include <optional>
#include <string>

#include "base/input_error.h"
#include "render/scene/io/gaussian_formats.h"

namespace foci {
namespace {

constexpr std::size_t kHeader = 4096, kSectionHeader = 1024;
constexpr std::uint32_t kMaxSections = 65536;
constexpr float kUsualHarmonicsRange = 1.5f;  // of mode 2, where the header says none
constexpr std::uint32_t kQuantisation = 32767;

struct Mode {
  std::size_t number_bytes;    // of position, scale and rotation
  std::size_t harmonic_bytes;  // of one harmonic
  std::size_t colorAt() const { return 10 * number_bytes; }
  std::size_t harmonicsAt() const { return colorAt() + 4; }
};
constexpr std::array<Mode, 3> kModes = {{{4, 4}, {2, 2}, {2, 1}}};

struct KsplatHeader {
  std::uint32_t sections = 0, count = 0;
  unsigned mode = 0;
  float low = -kUsualHarmonicsRange, high = kUsualHarmonicsRange;  // of harmonics in bytes
};

struct Section {
  std::uint32_t count = 0, room = 0, bucket_size = 0, buckets = 0, full = 0, partial = 0;
  std::uint32_t quantisation = kQuantisation;
  float block = 0.0f;
  std::uint64_t bucket_bytes = 0, record_bytes = 0;
  int degree = 0;

  std::uint64_t bytes() const {
    return 4 * std::uint64_t{partial} + bucket_bytes * buckets + record_bytes * room;
  }
};

std::optional<KsplatHeader> headerOf(std::span<const unsigned char> bytes) {
  if (bytes.size() < kHeader || bytes[0] != 0 || bytes[1] < 1) return std::nullopt;
  KsplatHeader header{
      .sections = u32At(bytes, 4), .count = u32At(bytes, 16), .mode = u16At(bytes, 20)};
  if (header.mode >= kModes.size() || header.sections == 0 || header.sections > kMaxSections ||
      header.count == 0) {
    return std::nullopt;
  }
  const float low = floatAt(bytes, 36), high = floatAt(bytes, 40);
  if (low != 0.0f && std::isfinite(low)) header.low = low;
  if (high != 0.0f && std::isfinite(high)) header.high = high;
  return header;
}

Section sectionOf(std::span<const unsigned char> bytes, const Mode& mode, const std::string& file) {
  Section section{.count = u32At(bytes, 0),
                  .room = u32At(bytes, 4),
                  .bucket_size = u32At(bytes, 8),
                  .buckets = u32At(bytes, 12),
                  .full = u32At(bytes, 32),
                  .partial = u32At(bytes, 36),
                  .block = floatAt(bytes, 16),
                  .bucket_bytes = u16At(bytes, 20),
                  .degree = u16At(bytes, 40)};
  if (const std::uint32_t stated = u32At(bytes, 24); stated != 0) section.quantisation = stated;
  const auto refuse = [&](const auto&... what) { return InputError(file, what...); };
  if (section.degree > kMaxHarmonicsDegree) {
    throw refuse("has harmonics of degree ", section.degree, ": expected 0 to 3");
  }
  if (section.count > section.room) throw refuse("a section is damaged: more Gaussians than room");
  const bool in_buckets = &mode != kModes.data();
  if (in_buckets && (section.bucket_bytes < 12 || section.bucket_size == 0)) {
    throw refuse("a section is damaged: expected buckets with centres");
  }
  section.record_bytes =
      mode.harmonicsAt() +
      3 * static_cast<std::size_t>(harmonicsOf(section.degree)) * mode.harmonic_bytes;
  return section;
}

/// The Gaussians of one section.
class SectionReader {
 public:
  SectionReader(const FileBytes& file, const KsplatHeader& header, const Section& section,
                std::uint64_t at)
      : header_(header),
        mode_(kModes[header.mode]),
        section_(section),
        name_(file.name()),
        partial_(file.part(at, 4 * std::uint64_t{section.partial})),
        centres_(file.part(at + partial_.size(), section.bucket_bytes * section.buckets)),
        records_(file.part(at + partial_.size() + centres_.size(),
                           section.record_bytes * section.room)) {
    if (header.mode == 0) return;  // without buckets
    std::uint64_t held = std::uint64_t{section.full} * section.bucket_size;
    for (std::uint32_t i = 0; i < section.partial; ++i) held += u32At(partial_, 4 * i);
    if (held != section.count) {
      throw InputError(name_, "a section is damaged: ", section.count, " Gaussians, and ", held,
                       " in its buckets");
    }
  }

  void appendTo(GaussianCollector& collector, int degree) {
    const auto own = 3 * static_cast<std::size_t>(harmonicsOf(section_.degree));
    std::vector<float> harmonics(3 * static_cast<std::size_t>(harmonicsOf(degree)));
    bucket_end_ = std::uint64_t{section_.full} * section_.bucket_size;
    bucket_ = section_.full;
    if (section_.partial > 0) bucket_end_ += u32At(partial_, 0);
    for (std::uint32_t i = 0; i < section_.count; ++i) {
      const auto record = records_.subspan(section_.record_bytes * i, section_.record_bytes);
      for (std::size_t k = 0; k < own; ++k) harmonics[placeOf(k)] = harmonic(record, k);
      collector.append(gaussianOf(record, i), harmonics);
    }
  }

 private:
  /// Within a degree all values of a channel come together: the k-th value's place by coefficient.
  static std::size_t placeOf(std::size_t k) {
    std::size_t degree = 1, before = 0;
    while (k >= before + 3 * (2 * degree + 1)) before += 3 * (2 * degree++ + 1);
    const std::size_t of_degree = 2 * degree + 1;
    const std::size_t channel = (k - before) / of_degree, order = (k - before) % of_degree;
    return before + 3 * order + channel;
  }

  float number(std::span<const unsigned char> record, std::size_t i) const {
    return mode_.number_bytes == 4 ? floatAt(record, 4 * i)
                                   : glm::unpackHalf1x16(u16At(record, 2 * i));
  }

  float harmonic(std::span<const unsigned char> record, std::size_t k) const {
    const std::size_t at = mode_.harmonicsAt() + k * mode_.harmonic_bytes;
    if (mode_.harmonic_bytes == 4) return floatAt(record, at);
    if (mode_.harmonic_bytes == 2) return glm::unpackHalf1x16(u16At(record, at));
    return header_.low + static_cast<float>(record[at]) / 255.0f * (header_.high - header_.low);
  }

  /// The centre of the bucket that Gaussian `i` is in. Buckets that are full come first.
  glm::vec3 bucketOf(std::uint32_t i) {
    std::uint64_t bucket = 0;
    if (i < std::uint64_t{section_.full} * section_.bucket_size) {
      bucket = i / section_.bucket_size;
    } else {
      while (i >= bucket_end_ && bucket_ + 1 < section_.full + std::uint64_t{section_.partial}) {
        ++bucket_;
        bucket_end_ += u32At(partial_, 4 * (bucket_ - section_.full));
      }
      bucket = bucket_;
    }
    if (bucket >= section_.buckets) {
      throw InputError(name_, "a section is damaged: a Gaussian is in bucket ", bucket + 1, " of ",
                       section_.buckets);
    }
    return vec3At(centres_, section_.bucket_bytes * bucket);
  }

  RawGaussian gaussianOf(std::span<const unsigned char> record, std::uint32_t i) {
    const auto vector = [&](std::size_t first) {
      return glm::vec3(number(record, first), number(record, first + 1), number(record, first + 2));
    };
    glm::vec3 position(0.0f);
    if (mode_.number_bytes == 4) {
      position = vector(0);
    } else {
      const auto steps = static_cast<float>(section_.quantisation);
      const glm::vec3 stored(u16At(record, 0), u16At(record, 2), u16At(record, 4));
      position = bucketOf(i) + (stored - steps) * (0.5f * section_.block / steps);
    }
    const unsigned char* color = record.data() + mode_.colorAt();
    return {
        .position = position,
        .sigma = vector(3),
        .rotation = {number(record, 7), number(record, 8), number(record, 9), number(record, 6)},
        .opacity = static_cast<float>(color[3]) / 255.0f,
        .color = glm::vec3(color[0], color[1], color[2]) / 255.0f};
  }

  const KsplatHeader& header_;
  const Mode& mode_;
  const Section& section_;
  const std::string& name_;
  std::span<const unsigned char> partial_, centres_, records_;
  std::uint64_t bucket_ = 0, bucket_end_ = 0;  // the bucket that is not full, and where it ends
};

}  // namespace

bool isKsplatFile(const std::filesystem::path& path) {
  const auto header = headerOf(firstBytes(path, kHeader));
  if (!header) return false;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  // The least that the file needs.
  const Mode& mode = kModes[header->mode];
  return !error && size >= kHeader + std::uint64_t{header->sections} * kSectionHeader +
                               header->count * std::uint64_t{mode.harmonicsAt()};
}

GaussianFile readKsplatFile(const std::filesystem::path& path) {
  const FileBytes bytes(path);
  const auto header = headerOf(bytes.part(0, kHeader));
  if (!header) {
    throw InputError(
        bytes.name(),
        "is no .ksplat file: expected version 0.1, compression mode 0 to 2, and a section");
  }
  const std::uint64_t first = kHeader + std::uint64_t{header->sections} * kSectionHeader;
  std::vector<Section> sections;
  int degree = 0;
  std::uint64_t count = 0, at = first;
  for (std::uint32_t i = 0; i < header->sections; ++i) {
    sections.push_back(
        sectionOf(bytes.part(kHeader + std::uint64_t{i} * kSectionHeader, kSectionHeader),
                  kModes[header->mode], bytes.name()));
    if (sections.back().count > 0) degree = std::max(degree, sections.back().degree);
    count += sections.back().count;
    at += bytes.part(at, sections.back().bytes()).size();
  }
  GaussianFile file{.format = "KSPLAT"};
  GaussianCollector collector(file, count, degree);
  at = first;
  for (const Section& section : sections) {
    SectionReader(bytes, *header, section, at).appendTo(collector, degree);
    at += section.bytes();
  }
  finishGaussians(file, bytes.name());
  return file;
}

}  // namespace foci
