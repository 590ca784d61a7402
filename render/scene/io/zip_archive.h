// Reads the members of a ZIP archive (PKWARE, APPNOTE 6.3): stored or deflated, without encryption
// and without ZIP64.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "render/scene/io/file_bytes.h"

namespace foci {

class ZipArchive {
 public:
  /// Reads the directory. @param file  outlives it
  /// @throws InputError if there is no directory, or it is damaged
  explicit ZipArchive(const FileBytes& file);

  bool holds(const std::string& name) const { return members_.contains(name); }

  /// The unpacked member of this name.
  /// @throws InputError if there is none, it is damaged, or it is larger than `max_bytes`
  std::vector<unsigned char> read(const std::string& name, std::uint64_t max_bytes) const;

 private:
  struct Member {
    unsigned method = 0;
    std::uint32_t checksum = 0;
    std::uint64_t packed_bytes = 0, bytes = 0, header_at = 0;
  };

  const FileBytes& file_;
  std::map<std::string, Member> members_;
};

}  // namespace foci
