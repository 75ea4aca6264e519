// Fixed threads that run numbered chunks of work.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace dexremoe {

// A pool of `workers` threads, the caller's included. The number of chunks is chosen by the caller
// and must not depend on `workers`; sums are taken in chunk order by the caller afterwards. Then
// results are the same for every number of workers.
class ThreadPool {
 public:
  // workers = 0 takes the number of processors.
  explicit ThreadPool(int workers = 0);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int workers() const { return static_cast<int>(threads_.size()) + 1; }

  // Calls body(chunk, worker) once for every chunk in 0 .. chunks-1, worker in 0 .. workers()-1,
  // and returns when all are done. The first exception is rethrown. Not reentrant.
  void ParallelFor(int chunks, const std::function<void(int chunk, int worker)>& body);

 private:
  void Loop(int worker);
  void Drain(int worker);

  std::vector<std::thread> threads_;
  std::mutex mutex_;
  std::condition_variable start_, done_;
  const std::function<void(int, int)>* body_ = nullptr;
  std::atomic<int> next_{0};
  int chunks_ = 0;
  int busy_ = 0;
  unsigned long generation_ = 0;
  bool stop_ = false;
  std::exception_ptr error_;
};

}  // namespace dexremoe
