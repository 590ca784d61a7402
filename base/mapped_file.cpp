#include "base/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstring>

#include "base/input_error.h"

namespace foci {
namespace {

/// The mapped files, where a signal handler finds them. A place is free if `begin` is 0.
struct Place {
  std::atomic<std::uintptr_t> begin{0}, end{0};
  std::atomic<const char*> name{nullptr};
};
std::array<Place, 64> places;  // files beyond are mapped, and the handler does not know their names

void remember(std::uintptr_t begin, std::uintptr_t end, const char* name) {
  for (Place& place : places) {
    std::uintptr_t free = 0;
    if (!place.begin.compare_exchange_strong(free, begin)) continue;
    place.name = name;
    place.end = end;
    return;
  }
}

void forget(std::uintptr_t begin) {
  for (Place& place : places) {
    if (place.begin != begin) continue;
    place.end = 0;
    place.begin = 0;
    return;
  }
}

void say(const char* text) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text, std::strlen(text));
}

/// Calls only what a signal handler may call.
void onLostPage(int signal, siginfo_t* info, void* /*context*/) {
  const auto at = reinterpret_cast<std::uintptr_t>(info->si_addr);
  for (const Place& place : places) {
    if (at < place.begin || at >= place.end) continue;
    say("foci: ");
    say(place.name);
    say(": was cut short, or cannot be read any more, while foci used it\n");
    ::_exit(1);
  }
  ::signal(signal, SIG_DFL);  // not ours: the signal ends the program once this function returns
  ::raise(signal);
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) : name_(path.string()) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat status {};
  const bool good = file >= 0 && ::fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  if (good && status.st_size > 0) {
    size_ = static_cast<std::size_t>(status.st_size);
    at_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
  }
  if (file >= 0) ::close(file);
  if (!good || at_ == MAP_FAILED) throw InputError(name_, "cannot be read");
  const auto begin = reinterpret_cast<std::uintptr_t>(at_);
  if (at_ != nullptr) remember(begin, begin + size_, name_.c_str());
}

MappedFile::~MappedFile() {
  if (at_ == nullptr) return;
  forget(reinterpret_cast<std::uintptr_t>(at_));
  ::munmap(at_, size_);
}

void releasePages(std::span<const unsigned char> bytes) {
  static const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<std::uintptr_t>(bytes.data());
  const std::uintptr_t first = (begin + page - 1) / page * page - begin;  // whole pages only
  const std::uintptr_t end = (begin + bytes.size()) / page * page - begin;
  if (begin + end <= begin + first) return;
  ::madvise(const_cast<unsigned char*>(bytes.data()) + first, end - first, MADV_DONTNEED);
}

void readAhead(std::span<const unsigned char> bytes) {
  static const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const std::uintptr_t into = reinterpret_cast<std::uintptr_t>(bytes.data()) % page;
  ::madvise(const_cast<unsigned char*>(bytes.data()) - into, bytes.size() + into, MADV_WILLNEED);
}

void endOnLostPages() {
  struct sigaction action {};
  action.sa_sigaction = onLostPage;
  action.sa_flags = SA_SIGINFO;
  ::sigaction(SIGBUS, &action, nullptr);
}

void endOnLostPagesUnlessHandled() {
  struct sigaction now {};
  if (::sigaction(SIGBUS, nullptr, &now) != 0) return;
  if ((now.sa_flags & SA_SIGINFO) == 0 && now.sa_handler == SIG_DFL) endOnLostPages();
}

}  // namespace foci
