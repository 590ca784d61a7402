// XDF files of the Lab Streaming Layer (github.com/sccn/xdf, specification 1.0), packed with gzip
// (.xdfz) or not. Times are on the recorder's clock (recorder_clock.h). A sample without a time
// follows the one before by 1 / nominal rate. The texts of a marker's channels are joined by
// blanks.

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <utility>

#include "base/input_error.h"
#include "base/text.h"
#include "gaze/sources/column_names.h"
#include "gaze/sources/lsl_stream.h"
#include "gaze/sources/recording_formats.h"

namespace foci {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kXdfMagic = "XDF:";
constexpr std::size_t kMaxChannels = 1024, kLongestText = 200;
enum Tag : std::uint16_t { kStreamHeader = 2, kSamples = 3, kClockOffset = 4 };

/// The bytes end too early, or they are no length.
struct CutOff {};

/// Reads values in order. @throws CutOff past the end
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : bytes_(bytes) {}

  std::string_view rest() const { return bytes_; }

  std::string_view take(std::uint64_t count) {
    if (count > bytes_.size()) throw CutOff{};
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }

  template <class Number>
  Number number() {
    Number value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }

  /// A length: the number of its bytes (1, 4 or 8) comes first.
  std::uint64_t length() {
    switch (number<std::uint8_t>()) {
      case 1:
        return number<std::uint8_t>();
      case 4:
        return number<std::uint32_t>();
      case 8:
        return number<std::uint64_t>();
    }
    throw CutOff{};
  }

 private:
  std::string_view bytes_;
};

/// What stands between <name> and </name>, the first time from `from` on.
std::string_view element(std::string_view xml, const std::string& name) {
  const std::string open = "<" + name + ">", close = "</" + name + ">";
  const std::size_t begin = xml.find(open);
  if (begin == xml.npos) return {};
  const std::size_t end = xml.find(close, begin);
  if (end == xml.npos) return {};
  return trimmed(xml.substr(begin + open.size(), end - begin - open.size()));
}

/// A name without what would end a column's name.
std::string plain(std::string_view text) {
  std::string name(text.substr(0, 64));
  for (char& c : name) {
    if (c == '\t' || c == '"' || static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return name;
}

struct Stream : LslStream {
  std::uint32_t id = 0;
  std::vector<std::string_view> chunks{};  // of samples
  std::vector<ClockOffset> clock{};
};

struct Samples {
  std::vector<double> times_s{};
  std::vector<double> values{};      // channel by channel, sample after sample
  std::vector<std::string> texts{};  // of a stream of texts, one a sample
};

/// The label of a channel, else its eye and type, else its number; with its unit.
std::string channelName(std::string_view channel, std::size_t number) {
  std::string name = plain(element(channel, "label"));
  if (name.empty()) {
    const std::string_view eye = element(channel, "eye");
    name = plain(std::string(eye) + (eye.empty() || eye == "both" ? "" : "_") +
                 std::string(element(channel, "type")));
  }
  if (name.empty()) name = "channel" + std::to_string(number + 1);
  std::string unit = plain(element(channel, "unit"));
  if (std::string known = unitIn(lowered(unit)); !known.empty()) unit = std::move(known);
  const bool stated = unit == "norm" && name.find("norm") != name.npos;
  if (stated || unit.find_first_of("[]()") != unit.npos || name.find_first_of("[(") != name.npos) {
    unit = {};
  }
  return unit.empty() ? name : name + " [" + unit + "]";
}

double valueIn(Bytes& bytes, const std::string& format, const std::string& file) {
  if (format == "float32") return static_cast<double>(bytes.number<float>());
  if (format == "double64") return bytes.number<double>();
  if (format == "int64") return static_cast<double>(bytes.number<std::int64_t>());
  if (format == "int32") return bytes.number<std::int32_t>();
  if (format == "int16") return bytes.number<std::int16_t>();
  if (format == "int8") return bytes.number<std::int8_t>();
  throw InputError(file, "channel format " + shown(format) + ": expected one of XDF's");
}

/// The texts of all channels, each cut to `kLongestText`.
std::string textIn(Bytes& bytes, std::size_t channels) {
  std::string text;
  for (std::size_t channel = 0; channel < channels; ++channel) {
    const std::string_view one = trimmed(bytes.take(bytes.length()).substr(0, kLongestText));
    if (!one.empty()) text.append(text.empty() ? "" : " ").append(one);
  }
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return text;
}

/// The whole samples of a chunk. @throws CutOff behind them if it ends within a sample
void readSamples(Bytes bytes, const Stream& stream, Samples& samples, const std::string& file) {
  const std::uint64_t count = bytes.length();
  std::vector<double> row(stream.hasNumbers() ? stream.channels : 0);
  for (std::uint64_t i = 0; i < count; ++i) {
    double time_s = 0.0;
    const auto stamp_bytes = bytes.number<std::uint8_t>();
    if (stamp_bytes == 8) {
      time_s = bytes.number<double>();
    } else if (stamp_bytes == 0 && stream.rate_Hz > 0.0 && !samples.times_s.empty()) {
      time_s = samples.times_s.back() + 1.0 / stream.rate_Hz;
    } else {
      throw InputError(file, "stream " + shown(stream.name) + ": a sample without a time");
    }
    std::string text = stream.hasTexts() ? textIn(bytes, stream.channels) : "";
    for (double& value : row) value = valueIn(bytes, stream.format, file);
    if (stream.hasTexts()) samples.texts.push_back(std::move(text));
    samples.values.insert(samples.values.end(), row.begin(), row.end());
    samples.times_s.push_back(time_s);
  }
}

/// Unpacked, if it is packed. @throws InputError
std::string bytesOf(const std::filesystem::path& file) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> in(gzopen(file.string().c_str(), "rb"), gzclose);
  if (!in) throw InputError(file.string(), "cannot be read");
  std::string bytes;
  for (std::size_t block_B = 1 << 20;;) {
    const std::size_t before = bytes.size();
    bytes.resize(before + block_B);
    const int count = gzread(in.get(), bytes.data() + before, static_cast<unsigned>(block_B));
    bytes.resize(before + static_cast<std::size_t>(std::max(count, 0)));
    if (count <= 0) return bytes;  // what is cut off is found in the chunks
    requirePackedRecording(file.string(), static_cast<std::int64_t>(bytes.size()),
                           gzoffset(in.get()));
  }
}

/// The streams of a file, in its order.
class XdfFile {
 public:
  XdfFile(std::string_view all, std::string file) : all_(all), file_(std::move(file)) {
    Bytes chunks(all);
    try {
      chunks.take(kXdfMagic.size());
      while (!chunks.rest().empty()) {
        const std::uint64_t length = chunks.length();
        const std::string_view rest = chunks.rest();
        readChunk(rest.substr(0, length), length > rest.size());
        chunks.take(length);
      }
    } catch (const CutOff&) {
      cut_off_ = "cut off or damaged " + std::to_string(chunks.rest().size()) + " bytes before " +
                 "its end, in an XDF chunk: what follows is left out";
    }
  }

  const std::optional<std::string>& cutOff() const { return cut_off_; }

  const Stream& gazeStream(std::string_view wanted) const {
    const Stream* found = nullptr;
    std::string names;
    std::size_t count = 0;
    for (std::size_t i = 0; i < streams_.size(); ++i) {
      const Stream& stream = streams_[i];
      const std::string number = "#" + std::to_string(i + 1);
      names += (names.empty() ? "" : ", ") + number + " " + shown(stream.name) +
               (stream.hasTexts() ? " (texts, not numbers)" : "");
      const bool is = wanted.empty()
                          ? stream.isGaze()
                          : (stream.name == wanted || number == wanted) && stream.hasNumbers();
      if (!is) continue;
      found = &stream;
      ++count;
    }
    if (count == 1) return *found;
    const std::string where = cut_off_ ? "; the file is " + *cut_off_ : "";
    if (names.empty()) throw InputError(file_, "no streams: expected a recording of gaze" + where);
    throw InputError(
        file_, (count == 0 ? "no stream of gaze" : "more than one stream of gaze") +
                   (": expected gaze.stream, the name or the number of one of " + names + where));
  }

  /// On the recorder's clock.
  Samples samplesOf(const Stream& stream, int& resets) const {
    Samples samples;
    for (const std::string_view chunk : stream.chunks) {
      try {
        readSamples(Bytes(chunk), stream, samples, file_);
      } catch (const CutOff&) {
        if (chunk.end() != all_.end()) {
          throw InputError(file_, "damaged: an XDF chunk of samples of stream " +
                                      shown(stream.name) + " ends too early");
        }
      }
    }
    try {
      resets = toRecorderClock(samples.times_s, stream.clock);
    } catch (const std::invalid_argument&) {
      throw InputError(file_, "stream " + shown(stream.name) +
                                  ": its clock offsets change by half a second in a second, or "
                                  "faster: expected those of two clocks");
    }
    return samples;
  }

  std::vector<TraceMarker> markers() const {
    std::vector<TraceMarker> markers;
    for (const Stream& stream : streams_) {
      if (!stream.isMarkers()) continue;
      int resets = 0;
      const Samples samples = samplesOf(stream, resets);
      for (std::size_t i = 0; i < samples.times_s.size(); ++i) {
        std::string text = stream.hasTexts() ? samples.texts[i] : "";
        for (std::size_t c = 0; stream.hasNumbers() && c < stream.channels; ++c) {
          text += (c == 0 ? "" : " ") + exactText(samples.values[i * stream.channels + c]);
        }
        if (!std::isfinite(samples.times_s[i]) || text.empty()) continue;
        markers.push_back({samples.times_s[i], std::move(text)});
      }
    }
    std::ranges::stable_sort(markers, {}, &TraceMarker::time_s);
    return markers;
  }

 private:
  /// @param is_cut  the file ends within the chunk: of samples, the first ones are whole
  void readChunk(std::string_view content, bool is_cut) {
    Bytes chunk(content);
    const auto tag = chunk.number<std::uint16_t>();
    if (tag != kStreamHeader && tag != kSamples && tag != kClockOffset) return;
    const auto id = chunk.number<std::uint32_t>();
    if (tag == kStreamHeader) {
      if (is_cut) return;
      streams_.push_back({lslStreamOf(chunk.rest(), file_), id});
      return;
    }
    const auto stream = std::ranges::find(streams_, id, &Stream::id);
    if (stream == streams_.end()) {
      throw InputError(file_, "damaged: an XDF chunk comes before the header of its stream");
    }
    if (tag == kSamples) {
      stream->chunks.push_back(chunk.rest());
    } else {
      const auto collected_s = chunk.number<double>();
      stream->clock.push_back({collected_s, chunk.number<double>()});
    }
  }

  std::string_view all_;
  std::string file_;
  std::vector<Stream> streams_{};
  std::optional<std::string> cut_off_{};
};

bool isXdf(const RecordingFile& file) {
  return unpackedStart(file.path(), kXdfMagic.size()) == kXdfMagic;
}

/// Of the stream `gaze.stream`, else of the only stream of gaze (`LslStream::isGaze`).
TraceHeader readXdf(const RecordingFile& file, const Screen& fallback_screen,
                    const TakeSample& take) {
  const std::string bytes = bytesOf(file.path());
  const XdfFile xdf(bytes, file.path().string());
  const Stream& stream = xdf.gazeStream(file.columns().stream);
  std::vector<TraceMarker> markers = xdf.markers();
  int resets = 0;
  Samples samples = xdf.samplesOf(stream, resets);
  if (stream.rate_Hz > 0.0) removeJitter(samples.times_s);
  std::vector<double> values;
  for (std::size_t i = 0; i < samples.times_s.size(); ++i) {
    values.push_back(samples.times_s[i]);
    const auto row = samples.values.begin() + static_cast<std::ptrdiff_t>(i * stream.channels);
    values.insert(values.end(), row, row + static_cast<std::ptrdiff_t>(stream.channels));
  }
  NumberRows rows(file.path().string(), stream.columns, std::move(values),
                  {.rate_Hz = stream.rate_Hz > 0.0 ? std::optional(stream.rate_Hz) : std::nullopt,
                   .of_scene_camera = stream.of_scene_camera});
  TraceHeader header = readRows(rows, file.columns(), fallback_screen, take);
  header.format = "XDF, stream " + shown(stream.name) + ", " + header.format;
  header.markers = std::move(markers);
  if (stream.clock.empty()) {
    header.assumed.push_back("clock: the stream's own, since the file has no clock offsets");
  }
  if (resets > 0) {
    header.assumed.push_back("clock: the tracker's was reset " + std::to_string(resets) +
                             " times, and the offsets of each part hold there");
  }
  if (xdf.cutOff()) header.warnings.push_back("the file is " + *xdf.cutOff());
  return header;
}

}  // namespace

bool LslStream::isMarkers() const {
  return hasTexts() || (hasNumbers() && rate_Hz == 0.0 && lowered(type) == "markers");
}

bool LslStream::isGaze() const {
  const std::string both = lowered(type + " " + name);
  return hasNumbers() && !isMarkers() &&
         (both.find("gaze") != both.npos || both.find("eye") != both.npos);
}

LslStream lslStreamOf(std::string_view xml, const std::string& file) {
  LslStream stream{.name = plain(element(xml, "name")),
                   .type = plain(element(xml, "type")),
                   .format = plain(element(xml, "channel_format"))};
  const auto channels = parseNumber(element(xml, "channel_count"));
  if (!channels || *channels < 0.0 || *channels > static_cast<double>(kMaxChannels)) {
    throw InputError(file, "stream " + shown(stream.name) + ": expected up to 1024 channels");
  }
  stream.channels = static_cast<std::size_t>(*channels);
  stream.rate_Hz = parseNumber(element(xml, "nominal_srate")).value_or(0.0);
  stream.of_scene_camera =
      stream.name.ends_with("Neon Gaze") || xml.find("<coordinate_system>image-space<") != xml.npos;
  std::string_view rest = element(xml, "channels");
  std::vector<std::string> names, eyes;
  for (std::size_t i = 0; i < stream.channels; ++i) {
    const std::string_view channel = element(rest, "channel");
    names.push_back(channelName(channel, i));
    eyes.push_back(plain(element(channel, "eye")));
    if (!channel.empty()) {
      rest.remove_prefix(static_cast<std::size_t>(channel.end() - rest.begin()));
    }
  }
  for (std::size_t i = 0; i < stream.channels; ++i) {
    const bool of_one_eye = eyes[i] == "left" || eyes[i] == "right";
    const bool has_twin = std::ranges::count(names, names[i]) > 1;
    stream.columns.push_back(of_one_eye && has_twin ? eyes[i] + "_" + names[i] : names[i]);
  }
  return stream;
}

const RecordingFormat kXdf{.name = "XDF", .is = isXdf, .read = readXdf};

}  // namespace foci
