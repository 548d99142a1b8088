// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <thread>

#include "surefoot/core/executor.hpp"

namespace surefoot::stereo::test {

/// Last index first: shows results that depend on the order.
class Backwards final : public Executor {
  public:
    void parallel_for(int count, const std::function<void(int)>& work) override {
        for (int index = count - 1; index >= 0; --index) work(index);
    }
};

/// Even and odd indices on two threads.
class TwoThreads final : public Executor {
  public:
    void parallel_for(int count, const std::function<void(int)>& work) override {
        std::thread odd([&] {
            for (int index = 1; index < count; index += 2) work(index);
        });
        for (int index = 0; index < count; index += 2) work(index);
        odd.join();
    }
};

}  // namespace surefoot::stereo::test
