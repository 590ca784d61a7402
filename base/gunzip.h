// Unpacks gzip.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

struct z_stream_s;  // of zlib

namespace foci {

bool isGzip(std::span<const unsigned char> bytes);

/// Unpacks gzip (RFC 1952) part by part, so that a file cannot ask for more memory than its reader
/// expects. Streams may follow one another.
class Gunzip {
 public:
  /// @param packed  outlives it
  Gunzip(std::string name, std::span<const unsigned char> packed);
  ~Gunzip();
  Gunzip(const Gunzip&) = delete;
  Gunzip& operator=(const Gunzip&) = delete;

  /// Writes the next bytes, at most `count`; none at the end only.
  /// @return their number
  /// @throws InputError if the stream is damaged here, or the file ends before it
  std::size_t next(unsigned char* to, std::size_t count);
  std::vector<unsigned char> next(std::size_t count);

  /// Exactly `count` bytes. @throws InputError, also if there are fewer
  std::vector<unsigned char> take(std::size_t count);

 private:
  std::string name_;
  std::span<const unsigned char> rest_;  // not unpacked yet
  std::unique_ptr<z_stream_s> stream_;
  bool ended_ = false;
};

}  // namespace foci
