// Large arrays of plain numbers, aligned for vectors and huge pages.
#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

namespace dexremoe {

// Zeros at first. Where the system offers huge pages on request, large arrays ask for them: the
// kernels gather from all over a field, and address translation is what that waits for.
template <typename T>
class BigArray {
 public:
  BigArray() = default;
  explicit BigArray(std::size_t count) : size_(count) {
    const std::size_t bytes = (count * sizeof(T) + kPage - 1) / kPage * kPage;
    data_.reset(static_cast<T*>(::operator new(bytes, std::align_val_t(kPage))));
    madvise(data_.get(), bytes, MADV_HUGEPAGE);  // only advice: small pages do as well
    std::fill_n(data_.get(), count, T());
  }

  std::size_t size() const { return size_; }
  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  T& operator[](std::size_t i) { return data_.get()[i]; }
  const T& operator[](std::size_t i) const { return data_.get()[i]; }

 private:
  static constexpr std::size_t kPage = std::size_t{2} << 20;
  struct Delete {
    void operator()(T* p) const { ::operator delete(p, std::align_val_t(kPage)); }
  };

  std::size_t size_ = 0;
  std::unique_ptr<T, Delete> data_;
};

}  // namespace dexremoe
