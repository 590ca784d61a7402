#include "gaze/sources/xdf.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <glm/glm.hpp>
#include <iterator>
#include <map>
#include <optional>
#include <vector>

#include "base/input_error.h"
#include "base/number.h"
#include "base/text.h"

namespace foci {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kXdfMagic = "XDF:";
constexpr std::size_t kMaxChannels = 1024, kLongestText = 200;
enum Tag : std::uint16_t { kStreamHeader = 2, kSamples = 3, kClockOffset = 4 };

/// Reads values in order. @throws InputError past the end
class Bytes {
 public:
  Bytes(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  bool atEnd() const { return bytes_.empty(); }
  std::string_view rest() const { return bytes_; }

  std::string_view take(std::uint64_t count) {
    if (count > bytes_.size()) throw InputError(file_, "damaged: an XDF chunk ends too early");
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
    throw InputError(file_, "damaged: expected a length of an XDF chunk");
  }

 private:
  std::string_view bytes_;
  const std::string& file_;
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
  std::vector<double> times{};
  std::vector<double> values{};      // channel by channel, sample after sample
  std::vector<std::string> texts{};  // of a stream of texts, one a sample
  std::vector<glm::dvec2> clock{};   // time of the stream, offset to the recorder
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
  static const std::map<std::string, std::string> kShort = {
      {"pixels", "px"},   {"pixel", "px"},  {"millimeters", "mm"},
      {"degrees", "deg"}, {"seconds", "s"}, {"normalized", "norm"}};
  if (const auto found = kShort.find(unit); found != kShort.end()) unit = found->second;
  if (unit.find_first_of("[]()") != unit.npos || name.find_first_of("[(") != name.npos) unit = {};
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

void readSamples(Bytes& bytes, Stream& stream, const std::string& file) {
  const std::uint64_t count = bytes.length();
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto stamp_bytes = bytes.number<std::uint8_t>();
    if (stamp_bytes == 8) {
      stream.times.push_back(bytes.number<double>());
    } else if (stamp_bytes == 0 && stream.rate_Hz > 0.0 && !stream.times.empty()) {
      stream.times.push_back(stream.times.back() + 1.0 / stream.rate_Hz);
    } else {
      throw InputError(file, "stream " + shown(stream.name) + ": a sample without a time");
    }
    if (stream.hasTexts()) stream.texts.push_back(textIn(bytes, stream.channels));
    for (std::size_t channel = 0; stream.hasNumbers() && channel < stream.channels; ++channel) {
      stream.values.push_back(valueIn(bytes, stream.format, file));
    }
  }
}

std::map<std::uint32_t, Stream> streamsIn(std::string_view all, const std::string& file) {
  std::map<std::uint32_t, Stream> streams;
  Bytes chunks(all, file);
  chunks.take(kXdfMagic.size());
  while (!chunks.atEnd()) {
    Bytes chunk(chunks.take(chunks.length()), file);
    const auto tag = chunk.number<std::uint16_t>();
    if (tag != kStreamHeader && tag != kSamples && tag != kClockOffset) continue;
    const auto id = chunk.number<std::uint32_t>();
    if (tag == kStreamHeader) {
      streams[id] = {lslStreamOf(chunk.rest(), file)};
      continue;
    }
    const auto found = streams.find(id);
    if (found == streams.end()) throw InputError(file, "damaged: samples before their stream");
    if (tag == kClockOffset) {
      const double collected_s = chunk.number<double>(), offset_s = chunk.number<double>();
      found->second.clock.push_back({collected_s - offset_s, offset_s});
    } else if (found->second.hasNumbers() || found->second.hasTexts()) {
      readSamples(chunk, found->second, file);
    }
  }
  return streams;
}

/// What to add to a stream's time: the line through its clock offsets.
glm::dvec2 clockLine(const std::vector<glm::dvec2>& clock) {
  if (clock.empty()) return {0.0, 0.0};
  glm::dvec2 mean(0.0);
  for (const glm::dvec2& point : clock) mean += point / static_cast<double>(clock.size());
  double slope = 0.0, spread = 0.0;
  for (const glm::dvec2& point : clock) {
    slope += (point.x - mean.x) * (point.y - mean.y);
    spread += (point.x - mean.x) * (point.x - mean.x);
  }
  slope = spread > 0.0 ? slope / spread : 0.0;
  return {mean.y - slope * mean.x, slope};
}

std::vector<TraceMarker> markersOf(const std::map<std::uint32_t, Stream>& streams) {
  std::vector<TraceMarker> markers;
  for (const auto& [id, stream] : streams) {
    const glm::dvec2 clock = clockLine(stream.clock);
    for (std::size_t i = 0; i < stream.texts.size(); ++i) {
      const double time_s = stream.times[i] + clock.x + clock.y * stream.times[i];
      if (std::isfinite(time_s) && !stream.texts[i].empty()) {
        markers.push_back({time_s, stream.texts[i]});
      }
    }
  }
  std::ranges::stable_sort(markers, {}, &TraceMarker::time_s);
  return markers;
}

const Stream& gazeStream(const std::map<std::uint32_t, Stream>& streams, std::string_view wanted,
                         const std::string& file) {
  const Stream* found = nullptr;
  std::string names;
  std::size_t count = 0;
  for (const auto& [id, stream] : streams) {
    names += (names.empty() ? "" : ", ") + shown(stream.name);
    const bool is = wanted.empty() ? stream.isGaze() : stream.name == wanted && stream.hasNumbers();
    if (!is) continue;
    found = &stream;
    ++count;
  }
  if (count == 1) return *found;
  if (names.empty()) throw InputError(file, "no streams: expected a recording of gaze");
  throw InputError(file, (count == 0 ? "no stream of gaze" : "more than one stream of gaze") +
                             (": expected gaze.stream, the name of one of " + names));
}

}  // namespace

bool LslStream::isGaze() const {
  std::string both = type + " " + name;
  for (char& c : both) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return hasNumbers() && (both.find("gaze") != both.npos || both.find("eye") != both.npos);
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
  std::string_view rest = element(xml, "channels");
  for (std::size_t i = 0; i < stream.channels; ++i) {
    const std::string_view channel = element(rest, "channel");
    stream.columns += '\t' + channelName(channel, i);
    if (!channel.empty()) {
      rest.remove_prefix(static_cast<std::size_t>(channel.end() - rest.begin()));
    }
  }
  return stream;
}

bool isXdf(const std::filesystem::path& file) {
  std::array<char, 4> magic{};
  std::ifstream in(file, std::ios::binary);
  return in.read(magic.data(), magic.size()) &&
         std::string_view(magic.data(), magic.size()) == kXdfMagic;
}

XdfTable readXdf(const std::filesystem::path& file, std::string_view wanted) {
  const std::string name = file.string();
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const auto streams = streamsIn(bytes, name);
  const Stream& stream = gazeStream(streams, wanted, name);
  const glm::dvec2 clock = clockLine(stream.clock);
  XdfTable table{.text = stream.columns,
                 .stream = stream.name,
                 .markers = markersOf(streams),
                 .clock_offsets = stream.clock.size()};
  table.text += '\n';
  for (std::size_t i = 0; i < stream.times.size(); ++i) {
    const double time_s = stream.times[i];
    table.text += exactText(time_s + clock.x + clock.y * time_s);
    for (std::size_t channel = 0; channel < stream.channels; ++channel) {
      table.text += '\t' + exactText(stream.values[i * stream.channels + channel]);
    }
    table.text += '\n';
  }
  return table;
}

}  // namespace foci
