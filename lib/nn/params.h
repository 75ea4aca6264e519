// Network parameters: one flat array with named blocks, so that optimiser, checkpoints, freezing
// and gradient reduction each are one loop.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dexremoe {

// A named rows x cols matrix (cols = 1 for a vector) inside the flat array.
struct ParamBlock {
  std::string name;  // "policy/trunk0/weight"
  std::int64_t rows = 0;
  std::int64_t cols = 0;
  std::int64_t offset = 0;
  std::int64_t size() const { return rows * cols; }
};

// The layout is constant once the network is built; values and gradients are plain vectors of
// size() elements beside it.
class ParamLayout {
 public:
  // Appends a block and returns its index. Names must be unique.
  int Add(const std::string& name, std::int64_t rows, std::int64_t cols);
  const std::vector<ParamBlock>& blocks() const { return blocks_; }
  const ParamBlock& block(int index) const { return blocks_[index]; }
  // Index by name, -1 when absent.
  int Find(const std::string& name) const;
  std::int64_t size() const { return size_; }

 private:
  std::vector<ParamBlock> blocks_;
  std::int64_t size_ = 0;
};

}  // namespace dexremoe
