// Scratch memory of one thread, taken buffer by buffer in a fixed order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dexremoe {

// Forward resets the workspace and takes its buffers; Backward resets it and takes the same ones in
// the same order, and so finds what Forward left there. Buffers keep their memory between uses.
template <typename T>
class Workspace {
 public:
  void Reset() { next_ = 0; }
  // At least `count` elements, not initialised. Stays valid until the buffer is taken anew with a
  // larger count.
  T* Take(std::int64_t count) {
    if (next_ == buffers_.size()) buffers_.emplace_back();
    std::vector<T>& buffer = buffers_[next_++];
    if (buffer.size() < static_cast<std::size_t>(count)) buffer.resize(count);
    return buffer.data();
  }

 private:
  std::vector<std::vector<T>> buffers_;
  std::size_t next_ = 0;
};

}  // namespace dexremoe
