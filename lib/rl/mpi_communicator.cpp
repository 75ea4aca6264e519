#include "rl/mpi_communicator.h"

#define OMPI_SKIP_MPICXX 1  // no C++ bindings
#include <mpi.h>

#include <cstdlib>
#include <exception>

#include "base/error.h"

namespace dexremoe {
namespace {

constexpr int kGatherTag = 1;

// Only the main thread of a rank calls it.
class MpiCommunicator final : public Communicator {
 public:
  MpiCommunicator() {
    int provided = 0;
    if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided) != MPI_SUCCESS ||
        provided < MPI_THREAD_FUNNELED)
      Fail("MPI: expected thread level FUNNELED, found {}", provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    MPI_Comm machine;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine);
    MPI_Comm_size(machine, &local_size_);
    MPI_Comm_free(&machine);
  }
  ~MpiCommunicator() override {
    if (std::uncaught_exceptions() == 0) MPI_Finalize();
  }

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  int local_size() const override { return local_size_; }

  void Broadcast(std::span<std::byte> bytes) override {
    MPI_Bcast(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, 0, MPI_COMM_WORLD);
  }

  // One message after another: together they may be longer than MPI can count.
  std::vector<std::vector<std::uint8_t>> Gather(const std::vector<std::uint8_t>& bytes) override {
    if (rank_ > 0) {
      MPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, 0, kGatherTag,
               MPI_COMM_WORLD);
      return {};
    }
    std::vector<std::vector<std::uint8_t>> parts = {bytes};
    for (int r = 1; r < size_; ++r) {
      MPI_Status status;
      int length = 0;
      MPI_Probe(r, kGatherTag, MPI_COMM_WORLD, &status);
      MPI_Get_count(&status, MPI_BYTE, &length);
      parts.emplace_back(length);
      MPI_Recv(parts.back().data(), length, MPI_BYTE, r, kGatherTag, MPI_COMM_WORLD,
               MPI_STATUS_IGNORE);
    }
    return parts;
  }

 private:
  std::vector<int> Lengths(const Slices& slices) const {
    std::vector<int> lengths(size_);
    for (int r = 0; r < size_; ++r) lengths[r] = slices[r + 1] - slices[r];
    return lengths;
  }
  void ExchangeSlices(std::span<const std::byte> mine, const Slices& slices,
                      std::span<std::byte> received) override {
    const std::vector<int> lengths = Lengths(slices);
    const std::vector<int> own(size_, lengths[rank_]);
    std::vector<int> places(size_);
    for (int r = 0; r < size_; ++r) places[r] = r * lengths[rank_];
    MPI_Alltoallv(mine.data(), lengths.data(), slices.data(), MPI_BYTE, received.data(), own.data(),
                  places.data(), MPI_BYTE, MPI_COMM_WORLD);
  }
  void CollectSlices(std::span<std::byte> all, const Slices& slices) override {
    const std::vector<int> lengths = Lengths(slices);
    MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, all.data(), lengths.data(), slices.data(),
                   MPI_BYTE, MPI_COMM_WORLD);
  }

  int rank_ = 0, size_ = 1, local_size_ = 1;
};

}  // namespace

bool StartedByMpi() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"})
    if (std::getenv(name) != nullptr) return true;
  return false;
}

std::unique_ptr<Communicator> MakeMpiCommunicator() { return std::make_unique<MpiCommunicator>(); }

}  // namespace dexremoe
