#include "app/platform/sha256.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>

#include <array>
#include <new>
#include <utility>
#include <vector>

#include "base/input_error.h"

namespace foci {

struct Sha256::State {
  EVP_MD_CTX* context = EVP_MD_CTX_new();
  ~State() { EVP_MD_CTX_free(context); }
};

Sha256::Sha256() : state_(std::make_unique<State>()) {
  if (!state_->context || !EVP_DigestInit_ex(state_->context, EVP_sha256(), nullptr)) {
    throw std::bad_alloc();
  }
}

Sha256::~Sha256() = default;

void Sha256::add(std::span<const unsigned char> bytes) {
  EVP_DigestUpdate(state_->context, bytes.data(), bytes.size());
}

std::string Sha256::hex() {
  std::array<unsigned char, 32> digest{};
  EVP_DigestFinal_ex(state_->context, digest.data(), nullptr);
  std::string text;
  for (const unsigned char byte : digest) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

std::string sha256Of(std::string_view bytes) {
  Sha256 hash;
  hash.add({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
  return hash.hex();
}

FileToHash::FileToHash(std::filesystem::path path)
    : path_(std::move(path)), file_(nullptr, &std::fclose) {
  requireRegularFile(path_);
  file_.reset(std::fopen(path_.c_str(), "rb"));
  if (!file_) throw InputError(path_.string(), "cannot be read");
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);
}

std::string FileToHash::sha256(const std::function<void()>& before_block) {
  // The pages of a file that may be larger than memory make room at once. Pages that are mapped,
  // as those of a scene, stay.
  constexpr off_t kKept_B = off_t{1} << 30;
  struct stat facts {};
  const int descriptor = ::fileno(file_.get());
  const bool releases = ::fstat(descriptor, &facts) == 0 && facts.st_size > kKept_B;
  Sha256 hash;
  std::vector<unsigned char> block(1 << 20);
  off_t done = 0;
  while (true) {
    if (before_block) before_block();
    const std::size_t got = std::fread(block.data(), 1, block.size(), file_.get());
    if (got == 0) break;
    hash.add({block.data(), got});
    if (releases) {
      ::posix_fadvise(descriptor, done, static_cast<off_t>(got), POSIX_FADV_DONTNEED);
    }
    done += static_cast<off_t>(got);
  }
  if (std::ferror(file_.get()) != 0) throw InputError(path_.string(), "cannot be read");
  return hash.hex();
}

std::string sha256OfFile(const std::filesystem::path& path) { return FileToHash(path).sha256(); }

}  // namespace foci
