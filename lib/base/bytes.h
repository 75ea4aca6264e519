// Flat byte images of plain state, for bit-exact save and restore.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "base/error.h"

namespace dexremoe {

class ByteWriter {
 public:
  template <typename T>
  void Put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* from = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof(T));
  }
  template <typename T>
  void PutVector(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    Put(static_cast<std::uint64_t>(values.size()));
    const auto* from = reinterpret_cast<const std::uint8_t*>(values.data());
    bytes_.insert(bytes_.end(), from, from + values.size() * sizeof(T));
  }
  std::vector<std::uint8_t> Take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

// Throws Error when the image ends too early or, in Finish, too late.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <typename T>
  T Get() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, Claim(sizeof(T)), sizeof(T));
    return value;
  }
  template <typename T>
  void GetInto(T& value) {
    value = Get<T>();
  }
  template <typename T>
  std::vector<T> GetVector() {
    const auto count = Get<std::uint64_t>();
    if (count > bytes_.size() / sizeof(T)) Fail("saved state: truncated at byte {}", position_);
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), Claim(count * sizeof(T)), count * sizeof(T));
    return values;
  }
  void Finish() const {
    if (position_ != bytes_.size())
      Fail("saved state: expected {} bytes, found {}", position_, bytes_.size());
  }

 private:
  const std::uint8_t* Claim(std::size_t size) {
    if (size > bytes_.size() - position_) Fail("saved state: truncated at byte {}", position_);
    const std::uint8_t* from = bytes_.data() + position_;
    position_ += size;
    return from;
  }
  std::span<const std::uint8_t> bytes_;
  std::size_t position_ = 0;
};

}  // namespace dexremoe
