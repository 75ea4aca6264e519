#include "base/thread_pool.h"

#include <algorithm>

namespace dexremoe {

ThreadPool::ThreadPool(int workers) {
  if (workers <= 0) workers = std::max(1u, std::thread::hardware_concurrency());
  for (int worker = 1; worker < workers; ++worker)
    threads_.emplace_back([this, worker] { Loop(worker); });
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  start_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ThreadPool::ParallelFor(int chunks, const std::function<void(int, int)>& body) {
  if (chunks <= 0) return;
  {
    const std::lock_guard lock(mutex_);
    body_ = &body;
    chunks_ = chunks;
    next_ = 0;
    busy_ = static_cast<int>(threads_.size());
    error_ = nullptr;
    ++generation_;
  }
  start_.notify_all();
  Drain(0);
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return busy_ == 0; });
  if (error_) std::rethrow_exception(error_);
}

void ThreadPool::Drain(int worker) {
  for (int chunk = next_++; chunk < chunks_; chunk = next_++) {
    try {
      (*body_)(chunk, worker);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      next_ = chunks_;
    }
  }
}

void ThreadPool::Loop(int worker) {
  unsigned long seen = 0;
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      start_.wait(lock, [&] { return stop_ || generation_ != seen; });
      if (stop_) return;
      seen = generation_;
    }
    Drain(worker);
    {
      const std::lock_guard lock(mutex_);
      --busy_;
    }
    done_.notify_one();
  }
}

}  // namespace dexremoe
