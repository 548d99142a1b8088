// SPDX-License-Identifier: Apache-2.0
#include "surefoot/perception/thread_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>

namespace surefoot {
namespace {

std::vector<int> calls_per_index(Executor& executor, int count) {
    std::vector<int> calls(static_cast<std::size_t>(count), 0);
    executor.parallel_for(count, [&](int index) { ++calls[static_cast<std::size_t>(index)]; });
    return calls;
}

TEST(ThreadPool, CallsEachIndexOnce) {
    for (const int threads : {1, 2, 5}) {
        ThreadPool pool(threads);
        EXPECT_EQ(pool.threads(), threads);
        for (const int count : {0, 1, 2, 3, 1000})
            EXPECT_EQ(calls_per_index(pool, count),
                      std::vector<int>(static_cast<std::size_t>(count), 1))
                << threads << " threads, " << count << " pieces";
    }
}

TEST(ThreadPool, ReturnsOnlyWhenAllIsDone) {
    ThreadPool pool(3);
    for (int round = 0; round < 3000; ++round) {  // short jobs: workers wake late or not at all
        std::atomic<int> done = 0;
        pool.parallel_for(4, [&](int) { done.fetch_add(1, std::memory_order_relaxed); });
        ASSERT_EQ(done.load(), 4) << "round " << round;
    }
}

TEST(ThreadPool, UsesMoreThanOneThread) {
    ThreadPool pool(2);
    std::atomic<int> arrived = 0;
    // Each item waits for the other item, so a single thread would never return.
    pool.parallel_for(2, [&](int) {
        ++arrived;
        while (arrived.load() < 2) std::this_thread::yield();
    });
    EXPECT_EQ(arrived.load(), 2);
}

TEST(ThreadPool, BringsTheFirstExceptionBackAndStaysUsable) {
    for (const int threads : {1, 3}) {
        ThreadPool pool(threads);
        for (int round = 0; round < 100; ++round) {
            std::atomic<int> begun = 0;
            const auto work = [&](int index) {
                ++begun;
                if (index == 7) throw std::runtime_error("seven");
            };
            EXPECT_THROW(pool.parallel_for(1000, work), std::runtime_error);
            if (threads == 1) {
                EXPECT_EQ(begun.load(), 8) << "the rest was not left out";
            }
        }
        EXPECT_EQ(calls_per_index(pool, 50), std::vector<int>(50, 1));
    }
}

TEST(ThreadPool, ANestedCallRunsOnItsOwnThread) {
    ThreadPool pool(2);
    std::atomic<int> sum = 0;
    pool.parallel_for(8, [&](int) { pool.parallel_for(5, [&](int index) { sum += index; }); });
    EXPECT_EQ(sum.load(), 8 * (0 + 1 + 2 + 3 + 4));
}

}  // namespace
}  // namespace surefoot
