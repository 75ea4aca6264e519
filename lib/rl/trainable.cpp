#include "rl/trainable.h"

#include <algorithm>

#include "base/check.h"

namespace dexremoe {

TrainableSet::TrainableSet(const ParamLayout& layout, const std::vector<std::uint8_t>& trainable)
    : layout_(layout), dense_offset_(layout.blocks().size(), -1) {
  DEX_CHECK_EQ(trainable.size(), layout.blocks().size());
  for (std::size_t i = 0; i < trainable.size(); ++i) {
    if (!trainable[i]) continue;
    const ParamBlock& block = layout.block(static_cast<int>(i));
    dense_offset_[i] = size_;
    if (!ranges_.empty() && ranges_.back().offset + ranges_.back().size == block.offset)
      ranges_.back().size += block.size();
    else
      ranges_.push_back({block.offset, size_, block.size()});
    size_ += block.size();
  }
}

const std::string& TrainableSet::BlockName(std::int64_t dense) const {
  int found = -1;
  for (std::size_t i = 0; i < dense_offset_.size(); ++i)
    if (dense_offset_[i] >= 0 && dense_offset_[i] <= dense) found = static_cast<int>(i);
  DEX_CHECK_GE(found, 0);
  return layout_.block(found).name;
}

void TrainableSet::Gather(const std::vector<float>& params, std::vector<float>& dense) const {
  dense.resize(size_);
  for (const Range& range : ranges_)
    std::copy_n(params.begin() + range.offset, range.size, dense.begin() + range.dense);
}

void TrainableSet::Scatter(const std::vector<float>& dense, std::vector<float>& params) const {
  for (const Range& range : ranges_)
    std::copy_n(dense.begin() + range.dense, range.size, params.begin() + range.offset);
}

}  // namespace dexremoe
