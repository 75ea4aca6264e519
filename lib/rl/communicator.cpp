#include "rl/communicator.h"

#include <algorithm>
#include <numeric>

#include "rl/mpi_communicator.h"

namespace dexremoe {
namespace {

class SingleProcess final : public Communicator {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }
  int local_size() const override { return 1; }
  void Broadcast(std::span<std::byte>) override {}
  std::vector<std::vector<std::uint8_t>> Gather(const std::vector<std::uint8_t>& bytes) override {
    return {bytes};
  }

 private:
  void ExchangeSlices(std::span<const std::byte> mine, const Slices&,
                      std::span<std::byte> received) override {
    std::copy(mine.begin(), mine.end(), received.begin());
  }
  void CollectSlices(std::span<std::byte>, const Slices&) override {}
};

template <typename T>
std::span<std::byte> BytesOf(std::vector<T>& values) {
  return std::as_writable_bytes(std::span(values));
}

}  // namespace

Communicator& Alone() {
  static SingleProcess single;
  return single;
}

std::unique_ptr<Communicator> StartCommunicator() {
  if (StartedByMpi()) return MakeMpiCommunicator();
  return std::make_unique<SingleProcess>();
}

void Communicator::Sum(std::span<float> values) { SumInRankOrder(values); }
void Communicator::Sum(std::span<double> values) { SumInRankOrder(values); }

// Each rank adds up one slice and hands the sums around: as many bytes on the wire as a ring
// all-reduce, but in an order that is fixed. MPI_Allreduce leaves the order to the library.
template <typename T>
void Communicator::SumInRankOrder(std::span<T> values) {
  const int ranks = size();
  if (ranks == 1) return;
  const auto start = [&](int r) { return values.size() * r / ranks; };
  Slices slices;
  for (int r = 0; r <= ranks; ++r) slices.push_back(static_cast<int>(start(r) * sizeof(T)));
  const std::span<T> own = values.subspan(start(rank()), start(rank() + 1) - start(rank()));
  std::vector<T> received(own.size() * ranks);
  ExchangeSlices(std::as_bytes(values), slices, BytesOf(received));
  std::copy_n(received.begin(), own.size(), own.begin());
  for (int r = 1; r < ranks; ++r)
    for (std::size_t i = 0; i < own.size(); ++i) own[i] += received[r * own.size() + i];
  CollectSlices(std::as_writable_bytes(values), slices);
}

std::vector<std::vector<std::uint8_t>> Communicator::AllGather(
    const std::vector<std::uint8_t>& bytes) {
  const std::vector<std::vector<std::uint8_t>> gathered = Gather(bytes);
  std::vector<std::uint64_t> lengths(size());
  std::vector<std::uint8_t> all;
  for (std::size_t r = 0; r < gathered.size(); ++r) {
    lengths[r] = gathered[r].size();
    all.insert(all.end(), gathered[r].begin(), gathered[r].end());
  }
  Broadcast(BytesOf(lengths));
  all.resize(std::reduce(lengths.begin(), lengths.end()));
  Broadcast(BytesOf(all));
  std::vector<std::vector<std::uint8_t>> parts;
  auto begin = all.begin();
  for (const std::uint64_t length : lengths) {
    parts.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(length));
    begin += static_cast<std::ptrdiff_t>(length);
  }
  return parts;
}

void Communicator::Barrier() {
  std::vector<double> none(size());
  Sum(none);
}

}  // namespace dexremoe
