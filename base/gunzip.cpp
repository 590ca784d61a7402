#include "base/gunzip.h"

#include <zlib.h>
#include <algorithm>
#include <functional>
#include <utility>

#include "base/input_error.h"

namespace foci {

bool isGzip(std::span<const unsigned char> bytes) {
  return bytes.size() >= 2 && bytes[0] == 0x1f && bytes[1] == 0x8b;
}

Gunzip::Gunzip(std::string name, std::span<const unsigned char> packed)
    : name_(std::move(name)), rest_(packed), stream_(std::make_unique<z_stream_s>()) {
  constexpr int kGzip = 16;  // expect its header
  if (inflateInit2(stream_.get(), MAX_WBITS + kGzip) != Z_OK) ended_ = true;
}

Gunzip::~Gunzip() { inflateEnd(stream_.get()); }

std::size_t Gunzip::next(unsigned char* to, std::size_t count) {
  constexpr std::size_t kPart = std::size_t{1} << 24u;  // bytes that zlib gets or returns at once
  std::size_t done = 0;
  while (done < count && !ended_) {
    const auto part = static_cast<uInt>(std::min(count - done, kPart));
    const std::size_t given = std::min(rest_.size(), kPart);
    // zlib takes a pointer that is not const, and does not write through it.
    stream_->next_in = const_cast<unsigned char*>(rest_.data());  // NOLINT
    stream_->avail_in = static_cast<uInt>(given);
    stream_->next_out = to + done;
    stream_->avail_out = part;
    const int result = inflate(stream_.get(), Z_NO_FLUSH);
    done += part - stream_->avail_out;
    rest_ = rest_.subspan(given - stream_->avail_in);
    const auto is_padding = [&] { return std::ranges::all_of(rest_, std::logical_not()); };
    if (result == Z_STREAM_END && (isGzip(rest_) || is_padding())) {
      ended_ = !isGzip(rest_) || inflateReset(stream_.get()) != Z_OK;
      continue;
    }
    if (result == Z_OK) continue;
    if (done > 0) break;  // what comes before the damage; the next call finds the damage again
    throw InputError(name_,
                     result == Z_BUF_ERROR ? "is damaged: the file ends before its gzip stream does"
                     : result == Z_STREAM_END ? "is damaged: other bytes follow its gzip stream"
                                              : "is damaged: its gzip stream is broken");
  }
  return done;
}

std::vector<unsigned char> Gunzip::next(std::size_t count) {
  std::vector<unsigned char> bytes(count);
  bytes.resize(next(bytes.data(), count));
  return bytes;
}

std::vector<unsigned char> Gunzip::take(std::size_t count) {
  std::vector<unsigned char> bytes = next(count);
  if (bytes.size() == count) return bytes;
  next(1);  // throws if the stream is damaged
  throw InputError(name_, "is damaged: its gzip stream is shorter than its header says");
}

}  // namespace foci
