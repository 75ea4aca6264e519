#include "nn/params.h"

#include "base/check.h"

namespace dexremoe {

int ParamLayout::Add(const std::string& name, std::int64_t rows, std::int64_t cols) {
  DEX_CHECK_GT(rows, 0);
  DEX_CHECK_GT(cols, 0);
  DEX_CHECK_EQ(Find(name), -1);
  blocks_.push_back({name, rows, cols, size_});
  size_ += rows * cols;
  return static_cast<int>(blocks_.size()) - 1;
}

int ParamLayout::Find(const std::string& name) const {
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    if (blocks_[i].name == name) return static_cast<int>(i);
  return -1;
}

}  // namespace dexremoe
