// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <thread>
#include <vector>

#include "surefoot/core/executor.hpp"

/// Executors with other orders of work than Serial: results must not depend on the order.
namespace surefoot {

/// Runs the last index first; reports more threads than most work has pieces.
class Backwards final : public Executor {
  public:
    [[nodiscard]] int threads() const noexcept override { return 5; }
    void parallel_for(int count, const std::function<void(int)>& work) override {
        for (int index = count - 1; index >= 0; --index) work(index);
    }
};

/// Distributes the indices over several threads.
class Threads final : public Executor {
  public:
    explicit Threads(int threads) : threads_(threads) {}
    [[nodiscard]] int threads() const noexcept override { return threads_; }
    void parallel_for(int count, const std::function<void(int)>& work) override {
        std::vector<std::thread> threads;
        threads.reserve(static_cast<std::size_t>(threads_));
        for (int first = 0; first < threads_; ++first) {
            threads.emplace_back([&, first] {
                for (int index = first; index < count; index += threads_) work(index);
            });
        }
        for (std::thread& thread : threads) thread.join();
    }

  private:
    int threads_;
};

}  // namespace surefoot
