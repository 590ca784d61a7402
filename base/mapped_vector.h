// A vector of its own values, or values of a mapped file that are read where they lie.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace foci {

/// Behaves as `std::vector<T>`. Values of a file are copied into memory before the first change, so
/// each member function that is not const may copy all of them.
template <typename T>
class MappedVector {
  static_assert(std::is_trivially_copyable_v<T>);
  using Vector = std::vector<T>;

 public:
  using value_type = T;

  MappedVector() = default;
  MappedVector(Vector values) : own_(std::move(values)) {}  // NOLINT: as a vector
  MappedVector(std::initializer_list<T> values) : own_(values) {}
  /// @param keep  keeps `mapped` valid
  MappedVector(std::span<const T> mapped, std::shared_ptr<const void> keep)
      : mapped_(mapped), keep_(std::move(keep)) {}

  std::size_t size() const { return keep_ ? mapped_.size() : own_.size(); }
  bool empty() const { return size() == 0; }
  bool isMapped() const { return keep_ != nullptr; }
  const T* data() const { return keep_ ? mapped_.data() : own_.data(); }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size(); }
  const T& operator[](std::size_t i) const { return data()[i]; }
  const T& front() const { return *data(); }
  const T& back() const { return data()[size() - 1]; }
  bool operator==(const MappedVector& other) const {
    if (size() != other.size()) return false;
    for (std::size_t i = 0; i < size(); ++i) {
      if (!((*this)[i] == other[i])) return false;
    }
    return true;
  }

  /// The values in memory, which the caller may change.
  Vector& own() {
    if (keep_) {
      own_.assign(mapped_.begin(), mapped_.end());
      mapped_ = {};
      keep_.reset();
    }
    return own_;
  }
  T* data() { return own().data(); }
  T* begin() { return data(); }
  T* end() { return data() + size(); }
  T& operator[](std::size_t i) { return own()[i]; }
  T& front() { return own().front(); }
  T& back() { return own().back(); }
  void push_back(const T& value) { own().push_back(value); }
  void reserve(std::size_t count) { own().reserve(count); }
  void resize(std::size_t count, const T& value = {}) { own().resize(count, value); }
  void assign(std::size_t count, const T& value) { own().assign(count, value); }
  void clear() { *this = MappedVector(); }
  void append(const MappedVector& more) { own().insert(own_.end(), more.begin(), more.end()); }

 private:
  Vector own_;  // empty where the values are mapped
  std::span<const T> mapped_;
  std::shared_ptr<const void> keep_;  // null: `own_` holds the values
};

}  // namespace foci
