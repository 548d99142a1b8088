// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace surefoot {

/// Runs independent pieces of work. The library starts no thread: the application makes an executor
/// and passes it in. Results must not depend on which thread runs which index, so that any executor
/// gives the same bytes; `Serial` is the reference.
class Executor {
  public:
    virtual ~Executor() = default;
    /// Calls `work(index)` once for each index in [0, count) and returns when all are done.
    virtual void parallel_for(int count, const std::function<void(int)>& work) = 0;
    /// How many pieces may run at the same time: says how much work to lay out at once, where less
    /// stays in the caches better.
    [[nodiscard]] virtual int threads() const noexcept { return 1; }
};

/// One after the other, in order, on the calling thread.
class Serial final : public Executor {
  public:
    void parallel_for(int count, const std::function<void(int)>& work) override {
        for (int index = 0; index < count; ++index) work(index);
    }
};

/// For callers that have none; holds no state.
[[nodiscard]] inline Executor& serial() noexcept {
    static Serial executor;
    return executor;
}

}  // namespace surefoot
