// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "surefoot/core/executor.hpp"

namespace surefoot::app {

/// Executor on `threads` threads, the calling one included. parallel_for must not be nested.
class ThreadPool final : public Executor {
  public:
    explicit ThreadPool(int threads);
    ~ThreadPool() override;
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    void parallel_for(int count, const std::function<void(int)>& work) override;
    [[nodiscard]] int width() const noexcept override {
        return static_cast<int>(workers_.size()) + 1;
    }

  private:
    void run_worker();
    void take_indices(std::unique_lock<std::mutex>& lock);

    std::mutex mutex_;
    std::condition_variable wake_;
    std::condition_variable done_;
    const std::function<void(int)>* work_ = nullptr;
    int count_ = 0;
    int next_ = 0;
    int running_ = 0;
    bool stopping_ = false;
    std::vector<std::thread> workers_;
};

}  // namespace surefoot::app
