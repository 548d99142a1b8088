// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace surefoot {

/// Runs independent pieces of work. Functions start no threads themselves: the application
/// creates an executor and passes it in. Results must not depend on which thread runs which index,
/// so that every executor gives the same bytes. `Serial` is the reference.
class Executor {
  public:
    virtual ~Executor() = default;
    /// Calls `work(index)` once for each index in [0, count) and returns when all are done.
    virtual void parallel_for(int count, const std::function<void(int)>& work) = 0;
    /// Largest number of pieces that run at the same time. Callers prepare only this many pieces at
    /// once, so that the data stay in the processor caches.
    [[nodiscard]] virtual int threads() const noexcept { return 1; }
};

/// Runs the pieces in order, one after the other, on the calling thread.
class Serial final : public Executor {
  public:
    void parallel_for(int count, const std::function<void(int)>& work) override {
        for (int index = 0; index < count; ++index) work(index);
    }
};

/// A shared serial executor for callers without their own. Holds no state.
[[nodiscard]] inline Executor& serial() noexcept {
    static Serial executor;
    return executor;
}

}  // namespace surefoot
