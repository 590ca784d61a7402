#include "gaze/sources/line_reader.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <utility>

namespace foci {
namespace {

constexpr std::size_t kMaxLine_B = 64 * 1024;      // far above the line of any tracker
constexpr std::size_t kBuffer_B = 4 * kMaxLine_B;  // large enough that refills cost nothing

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

// A packed recording is unpacked to about 5 times its size; a file that packs some bytes again and
// again reaches a thousand times.
constexpr std::int64_t kMaxUnpacked = 100;
constexpr std::int64_t kUnpackedAnyway_B = std::int64_t{64} << 20;

}  // namespace

LineReader::LineReader(const std::filesystem::path& file)
    : name_(file.string()), buffer_(kBuffer_B) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) throw InputError(name_, "is a folder");
  requireRegularFile(file);
  file_ = std::make_unique<PackedFile>(file);
}

bool LineReader::fill() {
  if (!file_) return false;
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  std::unique_ptr<PackedFile> file = std::move(file_);  // gone if it is damaged
  const std::size_t count = file->read(buffer_.data() + end_, kBuffer_B - end_);
  end_ += count;
  if (count > 0) file_ = std::move(file);
  return count > 0;
}

bool LineReader::next(std::string_view& line) {
  std::size_t searched = 0;
  const char* newline = nullptr;
  for (;;) {
    const char* from = buffer_.data() + begin_ + searched;
    const std::size_t left = end_ - begin_ - searched;
    newline = left > 0 ? static_cast<const char*>(std::memchr(from, '\n', left)) : nullptr;
    if (newline) break;
    searched = end_ - begin_;
    if (searched > kMaxLine_B || !fill()) break;
  }
  if (!newline && searched == 0) return false;
  ++number_;
  ended_ = newline != nullptr;
  const std::size_t length =
      newline ? static_cast<std::size_t>(newline - buffer_.data()) - begin_ : end_ - begin_;
  line = {buffer_.data() + begin_, length};
  if (number_ == 1 && !newline && line.find('\r') < line.find_last_not_of('\r') + 1)
    throw error("lines end in CR: expected LF or CRLF; convert with tr '\\r' '\\n' <OLD >NEW");
  if (length > kMaxLine_B) throw error("a line over 64 KiB: expected lines of text");
  begin_ += length + (newline ? 1 : 0);
  if (std::memchr(line.data(), '\0', line.size()))
    throw error("binary: expected UTF-8 text; export the recording as TSV, CSV or ASC");
  if (number_ == 1) line = withoutByteOrderMark(line);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return true;
}

InputError LineReader::error(const std::string& what) const {
  return InputError(name_ + ":" + std::to_string(number_), what);
}

bool equalsIgnoringCase(std::string_view text, std::string_view lower) {
  return std::ranges::equal(text, lower, [](char a, char b) { return lowered(a) == b; });
}

bool isAbsent(std::string_view field) {
  if (field.empty() || field == "." || field == "-") return true;
  constexpr std::size_t kLongest = 9;
  if (field.size() > kLongest || std::isdigit(static_cast<unsigned char>(field.back()))) {
    return false;
  }
  // Spreadsheets write #N/A; programs on Windows print words with brackets or 1.# for NaN.
  for (std::string_view word : {"nan", "na", "n/a", "#n/a", "null", "none", "-nan", "nan(ind)",
                                "-nan(ind)", "1.#ind", "-1.#ind", "1.#qnan", "-1.#qnan"}) {
    if (equalsIgnoringCase(field, word)) return true;
  }
  return false;
}

void splitFields(std::string_view line, char delimiter, std::vector<std::string_view>& fields,
                 std::size_t max_fields) {
  fields.clear();
  const bool quotes = std::memchr(line.data(), '"', line.size()) != nullptr;
  std::size_t at = 0;
  while (fields.size() < max_fields) {
    std::size_t end = at;
    bool quoted = false;
    if (quotes) {
      while (end < line.size() && (quoted || line[end] != delimiter)) quoted ^= line[end++] == '"';
    } else {
      while (end < line.size() && line[end] != delimiter) ++end;
    }
    std::string_view field = trimmed(line.substr(at, end - at));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') {
      field = trimmed(field.substr(1, field.size() - 2));
    }
    fields.push_back(field);
    if (end >= line.size()) return;
    at = end + 1;
  }
}

void splitWords(std::string_view line, std::vector<std::string_view>& words, std::size_t max_words,
                bool with_quotes) {
  words.clear();
  std::size_t at = 0;
  while (at < line.size() && words.size() < max_words) {
    if (isBlank(line[at])) {
      ++at;
      continue;
    }
    const std::size_t from = at;
    const std::size_t quote = with_quotes && line[at] == '"' ? line.find('"', at + 1) : line.npos;
    if (quote != line.npos) {
      words.push_back(line.substr(at + 1, quote - at - 1));
      at = quote + 1;
      continue;
    }
    while (at < line.size() && !isBlank(line[at])) ++at;
    words.push_back(line.substr(from, at - from));
  }
}

void splitRow(std::string_view line, char delimiter, std::vector<std::string_view>& fields,
              std::size_t max_fields) {
  if (delimiter == ' ') {
    splitWords(line, fields, max_fields, true);
  } else {
    splitFields(line, delimiter, fields, max_fields);
  }
}

void requirePackedRecording(const std::string& file, std::int64_t unpacked_B,
                            std::int64_t packed_B) {
  if (unpacked_B > kUnpackedAnyway_B && unpacked_B / kMaxUnpacked > packed_B) {
    throw InputError(file, "unpacks to more than 100 times its size: expected a recording");
  }
}

PackedFile::PackedFile(const std::filesystem::path& file)
    : file_(file), plain_(file, std::ios::binary) {
  if (isGzip(file_.bytes())) packed_.emplace(file_.name(), file_.bytes());
}

std::size_t PackedFile::read(char* to, std::size_t count) {
  if (packed_) {
    const std::size_t read = packed_->next(reinterpret_cast<unsigned char*>(to), count);
    unpacked_B_ += static_cast<std::int64_t>(read);
    requirePackedRecording(file_.name(), unpacked_B_,
                           static_cast<std::int64_t>(file_.bytes().size()));
    return read;
  }
  plain_.read(to, static_cast<std::streamsize>(count));
  return static_cast<std::size_t>(plain_.gcount());
}

}  // namespace foci
