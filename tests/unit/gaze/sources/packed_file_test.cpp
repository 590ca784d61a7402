// Damage anywhere in a packed file is reported: what is read is whole, or nothing.
#include "gaze/sources/line_reader.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <string>

#include "base/input_error.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

std::string packed(const std::string& text) {
  std::string bytes(compressBound(text.size()) + 32, '\0');
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  deflate(&stream, Z_FINISH);
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  return bytes;
}

/// All that a file holds; "refused" if it is damaged.
std::string contentOf(const std::string& bytes) {
  const TemporaryFolder folder;
  try {
    PackedFile file(folder.write("a.gz", bytes));
    std::string text;
    char block[1000];
    for (std::size_t n; (n = file.read(block, sizeof block)) > 0;) text.append(block, n);
    return text;
  } catch (const InputError&) {
    return "refused";
  }
}

const std::string kFirst(5000, 'a'), kSecond(3000, 'b');

TEST(PackedFile, JoinsMembersAndTakesPaddingAndPlainFiles) {
  EXPECT_EQ(contentOf(packed(kFirst) + packed(kSecond)), kFirst + kSecond);
  EXPECT_EQ(contentOf(packed(kFirst) + std::string(512, '\0')), kFirst);
  EXPECT_EQ(contentOf(packed("") + packed(kSecond)), kSecond);
  EXPECT_EQ(contentOf(kFirst), kFirst);
  EXPECT_EQ(contentOf(""), "");
}

TEST(PackedFile, EveryDamagedByteOfEveryMemberIsFound) {
  const std::string first = packed(kFirst), second = packed(kSecond);
  const std::string whole = first + second;
  std::size_t refused = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const std::size_t in_member = i < first.size() ? i : i - first.size();
    // The time, flags for people and the system's number mean nothing for the content; the first
    // two bytes say that the file is packed at all.
    if (i < 2 || (in_member >= 4 && in_member < 10)) continue;
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x40);
    // A few bits pad a member to whole bytes, and mean nothing.
    const std::string content = contentOf(damaged);
    refused += content == "refused";
    EXPECT_TRUE(content == "refused" || content == kFirst + kSecond) << "byte " << i;
  }
  EXPECT_GT(refused, whole.size() / 2);
}

TEST(PackedFile, ACutOrTrailingBytesAreFound) {
  const std::string first = packed(kFirst), whole = first + packed(kSecond);
  for (std::size_t size = 3; size < whole.size(); ++size) {
    if (size == first.size()) continue;  // a whole file
    EXPECT_EQ(contentOf(whole.substr(0, size)), "refused") << size << " bytes";
  }
  EXPECT_EQ(contentOf(first + "garbage"), "refused");
}

}  // namespace FOCI_FILE
}  // namespace foci
