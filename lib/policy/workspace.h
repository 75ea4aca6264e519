// Scratch memory of one thread, taken buffer by buffer in a fixed order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <vector>

namespace dexremoe {

// Forward resets the workspace and takes its buffers; Backward resets it and takes the same ones in
// the same order, and so finds what Forward left there. Buffers keep their memory between uses.
template <typename T>
class Workspace {
 public:
  void Reset() { next_ = 0; }
  // At least `count` elements, not initialised, on a cache line of their own. Stays valid until the
  // buffer is taken anew with a larger size.
  template <typename U = T>
  U* Take(std::int64_t count) {
    if (next_ == buffers_.size()) buffers_.emplace_back();
    Buffer& buffer = buffers_[next_++];
    const std::size_t size = static_cast<std::size_t>(count) * sizeof(U);
    if (buffer.size < size) {
      buffer.memory.reset(static_cast<std::byte*>(::operator new(size, kLine)));
      buffer.size = size;
    }
    return reinterpret_cast<U*>(buffer.memory.get());
  }

 private:
  static constexpr std::align_val_t kLine{64};
  struct Free {
    void operator()(std::byte* memory) const { ::operator delete(memory, kLine); }
  };
  struct Buffer {
    std::unique_ptr<std::byte, Free> memory;
    std::size_t size = 0;
  };
  std::vector<Buffer> buffers_;
  std::size_t next_ = 0;
};

}  // namespace dexremoe
