// Ranks as threads of one process, for tests without a launcher.
#pragma once

#include <algorithm>
#include <barrier>
#include <functional>
#include <thread>
#include <vector>

#include "rl/communicator.h"

namespace dexremoe {

class ThreadCommunicator final : public Communicator {
 public:
  // Where the ranks meet and show each other their arrays.
  struct Room {
    explicit Room(int ranks) : barrier(ranks), shown(ranks) {}
    std::barrier<> barrier;
    std::vector<std::span<const std::byte>> shown;
  };

  ThreadCommunicator(Room& room, int rank) : room_(room), rank_(rank) {}

  int rank() const override { return rank_; }
  int size() const override { return static_cast<int>(room_.shown.size()); }
  int local_size() const override { return size(); }

  void Broadcast(std::span<std::byte> bytes) override {
    Show(bytes, [&] {
      if (rank_ > 0) std::copy(room_.shown[0].begin(), room_.shown[0].end(), bytes.begin());
    });
  }
  std::vector<std::vector<std::uint8_t>> Gather(const std::vector<std::uint8_t>& bytes) override {
    std::vector<std::vector<std::uint8_t>> parts;
    Show(std::as_bytes(std::span(bytes)), [&] {
      for (const auto& part : room_.shown) {
        const auto* begin = reinterpret_cast<const std::uint8_t*>(part.data());
        if (rank_ == 0) parts.emplace_back(begin, begin + part.size());
      }
    });
    return parts;
  }

 private:
  void ExchangeSlices(std::span<const std::byte> mine, const Slices& slices,
                      std::span<std::byte> received) override {
    const int begin = slices[rank_], length = slices[rank_ + 1] - begin;
    Show(mine, [&] {
      for (int r = 0; r < size(); ++r)
        std::copy_n(room_.shown[r].begin() + begin, length, received.begin() + r * length);
    });
  }
  void CollectSlices(std::span<std::byte> all, const Slices& slices) override {
    Show(all, [&] {
      for (int r = 0; r < size(); ++r)
        if (r != rank_)
          std::copy(room_.shown[r].begin() + slices[r], room_.shown[r].begin() + slices[r + 1],
                    all.begin() + slices[r]);
    });
  }
  void Show(std::span<const std::byte> mine, const std::function<void()>& take) {
    room_.shown[rank_] = mine;
    room_.barrier.arrive_and_wait();
    take();
    room_.barrier.arrive_and_wait();
  }

  Room& room_;
  int rank_;
};

// Runs `body` once per rank, each in a thread of its own.
inline void RunRanks(int ranks, const std::function<void(Communicator&)>& body) {
  ThreadCommunicator::Room room(ranks);
  std::vector<std::jthread> threads;
  for (int rank = 0; rank < ranks; ++rank)
    threads.emplace_back([&room, &body, rank] {
      ThreadCommunicator communicator(room, rank);
      body(communicator);
    });
}

}  // namespace dexremoe
