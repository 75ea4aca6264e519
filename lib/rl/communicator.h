// The processes ("ranks") that train one policy together, each on its share of the environments.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace dexremoe {

// All ranks call the same functions in the same order, with arrays of the same length.
class Communicator {
 public:
  virtual ~Communicator() = default;

  virtual int rank() const = 0;        // 0 .. size() - 1
  virtual int size() const = 0;        // ranks
  virtual int local_size() const = 0;  // ranks on this machine, itself included

  // Replaces values by their sums over the ranks, taken in rank order: every rank gets the same
  // bits, every time.
  void Sum(std::span<float> values);
  void Sum(std::span<double> values);
  // Replaces bytes by those of rank 0.
  virtual void Broadcast(std::span<std::byte> bytes) = 0;
  // What every rank gave, in rank order, of any lengths; on rank 0 only, empty elsewhere.
  virtual std::vector<std::vector<std::uint8_t>> Gather(const std::vector<std::uint8_t>& bytes) = 0;
  // The same on every rank.
  std::vector<std::vector<std::uint8_t>> AllGather(const std::vector<std::uint8_t>& bytes);
  // Returns when every rank has come here.
  void Barrier();

 protected:
  // An array cut into a slice per rank: slice r is bytes [begin[r], begin[r + 1]).
  using Slices = std::vector<int>;
  // Sends slice r of `mine` to rank r. `received` holds this rank's slice as each rank had it, in
  // rank order.
  virtual void ExchangeSlices(std::span<const std::byte> mine, const Slices& slices,
                              std::span<std::byte> received) = 0;
  // Completes `all`, of which this rank holds its own slice.
  virtual void CollectSlices(std::span<std::byte> all, const Slices& slices) = 0;

 private:
  template <typename T>
  void SumInRankOrder(std::span<T> values);
};

// A single process: nothing to exchange.
Communicator& Alone();

// The ranks of an MPI launcher (mpirun, srun) when one started this process, else a single process.
// MPI is touched in the first case only, and finalised at destruction; not when an exception is on
// its way, as the other ranks would be waited for: the launcher then ends them.
std::unique_ptr<Communicator> StartCommunicator();

}  // namespace dexremoe
