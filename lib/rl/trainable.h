// The trainable blocks of a policy as one dense array.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nn/params.h"

namespace dexremoe {

class TrainableSet {
 public:
  // A run of neighbouring trainable elements.
  struct Range {
    std::int64_t offset;  // in the layout
    std::int64_t dense;   // in the dense array
    std::int64_t size;
  };

  TrainableSet(const ParamLayout& layout, const std::vector<std::uint8_t>& trainable);

  std::int64_t size() const { return size_; }
  const std::vector<Range>& ranges() const { return ranges_; }
  // Dense position of a block's first element; -1 when the block is frozen.
  std::int64_t DenseOffset(int block) const { return dense_offset_[block]; }
  // Name of the block that holds the dense element.
  const std::string& BlockName(std::int64_t dense) const;

  void Gather(const std::vector<float>& params, std::vector<float>& dense) const;
  void Scatter(const std::vector<float>& dense, std::vector<float>& params) const;

 private:
  const ParamLayout& layout_;
  std::vector<Range> ranges_;
  std::vector<std::int64_t> dense_offset_;
  std::int64_t size_ = 0;
};

}  // namespace dexremoe
