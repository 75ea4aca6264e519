#include "nn/bf16_product.h"

#include <dnnl.hpp>
#include <memory>
#include <unordered_map>
#include <vector>

#include "base/check.h"
#include "nn/one_thread.h"

namespace dexremoe {
namespace {

using DataType = dnnl::memory::data_type;

const dnnl::engine& Cpu() {
  static const dnnl::engine engine(dnnl::engine::kind::cpu, 0);
  return engine;
}

// A [rows, cols] operand as oneDNN sees it; transposed when it lies as [cols, rows].
dnnl::memory::desc Operand(std::int64_t rows, std::int64_t cols, std::int64_t stride,
                           bool transposed) {
  const dnnl::memory::dims strides =
      transposed ? dnnl::memory::dims{1, stride} : dnnl::memory::dims{stride, 1};
  return {{rows, cols}, DataType::bf16, strides};
}

dnnl::primitive_attr Attributes(const Bf16Product& p) {
  dnnl::post_ops epilogue;
  if (p.accumulate) epilogue.append_sum(1);
  if (p.activation == Activation::kElu)
    epilogue.append_eltwise(1, dnnl::algorithm::eltwise_elu, 1, 0);
  if (p.activation == Activation::kRelu)
    epilogue.append_eltwise(1, dnnl::algorithm::eltwise_relu, 0, 0);
  dnnl::primitive_attr attributes;
  attributes.set_post_ops(epilogue);
  attributes.set_scratchpad_mode(dnnl::scratchpad_mode::user);
  return attributes;
}

// A compiled product with the memory objects that its addresses are set in.
class Primitive {
 public:
  explicit Primitive(const Bf16Product& p) {
    const dnnl::memory::desc a = Operand(p.m, p.k, p.lda, p.transpose_a);
    const dnnl::memory::desc b = Operand(p.k, p.n, p.ldb, p.transpose_b);
    const dnnl::memory::desc bias = Operand(1, p.n, p.n, false);
    const dnnl::memory::desc c({p.m, p.n}, p.wide ? DataType::f32 : DataType::bf16,
                               dnnl::memory::dims{p.n, 1});
    const auto desc = p.bias ? dnnl::matmul::desc(a, b, bias, c) : dnnl::matmul::desc(a, b, c);
    const dnnl::matmul::primitive_desc made(desc, Attributes(p), Cpu());
    matmul_ = dnnl::matmul(made);
    scratch_size_ = made.scratchpad_desc().get_size();
    Add(DNNL_ARG_SRC, a);
    Add(DNNL_ARG_WEIGHTS, b);
    Add(DNNL_ARG_DST, c);
    Add(DNNL_ARG_SCRATCHPAD, made.scratchpad_desc());
    if (p.bias) Add(DNNL_ARG_BIAS, bias);
  }

  std::size_t scratch_size() const { return scratch_size_; }
  void Set(int argument, const void* address) {
    arguments_.at(argument).set_data_handle(const_cast<void*>(address));
  }
  void Run(dnnl::stream& stream) { matmul_.execute(stream, arguments_); }

 private:
  void Add(int argument, const dnnl::memory::desc& desc) {
    arguments_.emplace(argument, dnnl::memory(desc, Cpu(), DNNL_MEMORY_NONE));
  }

  dnnl::matmul matmul_;
  std::size_t scratch_size_ = 0;
  std::unordered_map<int, dnnl::memory> arguments_;
};

struct Hash {
  std::size_t operator()(const Bf16Product& p) const {
    std::size_t hash = 0;
    for (const std::int64_t value :
         {p.m, p.n, p.k, p.lda, p.ldb,
          std::int64_t{p.transpose_a + 2 * p.transpose_b + 4 * p.bias + 8 * p.wide +
                       16 * p.accumulate + 32 * static_cast<int>(p.activation)}})
      hash = hash * 0x9E3779B97F4A7C15ull + static_cast<std::size_t>(value);
    return hash;
  }
};

// What one thread keeps: primitives share their memory objects and the scratchpad.
struct ThreadState {
  dnnl::stream stream{Cpu()};
  std::unordered_map<Bf16Product, Primitive, Hash> primitives;
  std::vector<std::byte> scratch;
};

ThreadState& State() {
  thread_local ThreadState state;
  return state;
}

}  // namespace

std::size_t NumProducts() { return State().primitives.size(); }

void RunProduct(const Bf16Product& product, const BFloat16* a, const BFloat16* b,
                const BFloat16* bias, void* c) {
  DEX_CHECK(product.wide || !product.accumulate);
  KeepToOneThread();
  ThreadState& state = State();
  const auto [found, fresh] = state.primitives.try_emplace(product, product);
  Primitive& primitive = found->second;
  if (fresh && state.scratch.size() < primitive.scratch_size())
    state.scratch.resize(primitive.scratch_size());
  primitive.Set(DNNL_ARG_SRC, a);
  primitive.Set(DNNL_ARG_WEIGHTS, b);
  primitive.Set(DNNL_ARG_DST, c);
  primitive.Set(DNNL_ARG_SCRATCHPAD, state.scratch.data());
  if (product.bias) primitive.Set(DNNL_ARG_BIAS, bias);
  primitive.Run(state.stream);
}

}  // namespace dexremoe
