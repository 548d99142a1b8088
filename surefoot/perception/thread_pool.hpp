// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "surefoot/core/executor.hpp"

namespace surefoot {

/// Executor with `threads` threads, the caller included. A call during another call (nested, or
/// from a second thread) runs only on the thread of the caller. If an item throws, the items
/// already started finish, the others do not run, and the call rethrows the first exception.
class ThreadPool final : public Executor {
  public:
    explicit ThreadPool(int threads);
    ~ThreadPool() override;
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    void parallel_for(int count, const std::function<void(int)>& work) override;
    [[nodiscard]] int threads() const noexcept override {
        return static_cast<int>(workers_.size()) + 1;
    }

  private:
    void run_worker();
    void take_indices(std::unique_lock<std::mutex>& lock);

    std::mutex mutex_;
    std::condition_variable wake_;
    std::condition_variable done_;
    const std::function<void(int)>* work_ = nullptr;  ///< null while no call runs
    int count_ = 0;
    int next_ = 0;
    // Written with the mutex held. Some readers do not hold the mutex.
    std::atomic<int> running_ = 0;
    std::atomic<int> calls_ = 0;
    bool stopping_ = false;
    std::exception_ptr failure_;
    std::vector<std::thread> workers_;
};

}  // namespace surefoot
