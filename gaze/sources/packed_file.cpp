#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "gaze/sources/line_reader.h"

namespace foci {
namespace {

// A packed recording is unpacked to about 5 times its size; a file that packs some bytes again and
// again reaches a thousand times.
constexpr std::int64_t kMaxUnpacked = 100;
constexpr std::int64_t kUnpackedAnyway_B = std::int64_t{64} << 20;

constexpr std::size_t kBlock_B = 128 * 1024;
constexpr int kGzip = 16;  // of inflateInit2: gzip format alone

}  // namespace

void requirePackedRecording(const std::string& file, std::int64_t unpacked_B,
                            std::int64_t packed_B) {
  if (unpacked_B > kUnpackedAnyway_B && unpacked_B / kMaxUnpacked > packed_B) {
    throw InputError(file, "unpacks to more than 100 times its size: expected a recording");
  }
}

/// zlib's own reader of files takes a second member whose header is damaged for bytes to ignore, so
/// a part of a recording would be missing.
struct PackedFile::State {
  std::string name{};
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file{nullptr, &std::fclose};
  std::vector<unsigned char> bytes{};
  z_stream stream{};
  bool packed = false, between_members = false;
  std::int64_t packed_B = 0, unpacked_B = 0;

  bool refill() {
    stream.next_in = bytes.data();
    stream.avail_in = static_cast<uInt>(std::fread(bytes.data(), 1, bytes.size(), file.get()));
    packed_B += stream.avail_in;
    return stream.avail_in > 0;
  }

  void copy() {
    const uInt some = std::min(stream.avail_in, stream.avail_out);
    std::memcpy(stream.next_out, stream.next_in, some);
    stream.next_in += some;
    stream.avail_in -= some;
    stream.next_out += some;
    stream.avail_out -= some;
  }

  void unpack() {
    if (between_members) {
      if (*stream.next_in == 0) {  // padding
        ++stream.next_in;
        --stream.avail_in;
        return;
      }
      inflateReset(&stream);
      between_members = false;
    }
    const int status = inflate(&stream, Z_NO_FLUSH);
    between_members = status == Z_STREAM_END;
    if (status != Z_OK && status != Z_STREAM_END) refuse();
  }

  [[noreturn]] void refuse() const {
    throw InputError(name, "damaged: cannot be unpacked to its end");
  }
};

PackedFile::PackedFile(const std::filesystem::path& file) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.name = file.string();
  s.file.reset(std::fopen(s.name.c_str(), "rb"));
  if (!s.file) throw InputError(s.name, "cannot be read");
  s.bytes.resize(kBlock_B);
  s.refill();
  s.packed = s.stream.avail_in >= 2 && s.bytes[0] == 0x1f && s.bytes[1] == 0x8b &&
             inflateInit2(&s.stream, MAX_WBITS + kGzip) == Z_OK;
}

PackedFile::~PackedFile() {
  if (state_->packed) inflateEnd(&state_->stream);
}

std::size_t PackedFile::read(char* to, std::size_t count) {
  State& s = *state_;
  s.stream.next_out = reinterpret_cast<Bytef*>(to);
  s.stream.avail_out = static_cast<uInt>(count);
  while (s.stream.avail_out > 0 && (s.stream.avail_in > 0 || s.refill())) {
    if (s.packed) {
      s.unpack();
    } else {
      s.copy();
    }
  }
  const std::size_t read = count - s.stream.avail_out;
  if (!s.packed) return read;
  s.unpacked_B += static_cast<std::int64_t>(read);
  requirePackedRecording(s.name, s.unpacked_B, s.packed_B);
  if (read == 0 && !s.between_members) s.refuse();
  return read;
}

}  // namespace foci
