// SPDX-License-Identifier: Apache-2.0
#include "surefoot/perception/thread_pool.hpp"

#include <utility>

namespace surefoot {
namespace {

/// Polls `ready` for a while before the thread sleeps: waking a thread takes longer than many work
/// items. The loop yields the processor to other threads.
template <typename Ready>
void look_a_while(const Ready& ready) {
    constexpr int kLooks = 100;
    for (int i = 0; i < kLooks && !ready(); ++i) std::this_thread::yield();
}

}  // namespace

ThreadPool::ThreadPool(int threads) {
    for (int i = 1; i < threads; ++i) workers_.emplace_back([this] { run_worker(); });
}

ThreadPool::~ThreadPool() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stopping_ = true;
    }
    wake_.notify_all();
    for (auto& worker : workers_) worker.join();
}

void ThreadPool::parallel_for(int count, const std::function<void(int)>& work) {
    std::unique_lock<std::mutex> lock(mutex_);
    if (work_ != nullptr) {
        lock.unlock();
        Serial().parallel_for(count, work);
        return;
    }
    work_ = &work;
    count_ = count;
    next_ = 0;
    if (count > 1) {
        ++calls_;
        wake_.notify_all();
    }
    take_indices(lock);
    lock.unlock();
    look_a_while([this] { return running_ == 0; });
    lock.lock();
    done_.wait(lock, [this] { return running_ == 0; });
    work_ = nullptr;
    if (auto failure = std::exchange(failure_, nullptr)) std::rethrow_exception(failure);
}

void ThreadPool::take_indices(std::unique_lock<std::mutex>& lock) {
    while (work_ != nullptr && next_ < count_) {
        const int index = next_++;
        const auto* work = work_;
        ++running_;
        lock.unlock();
        std::exception_ptr failure;
        try {
            (*work)(index);
        } catch (...) {
            failure = std::current_exception();
        }
        lock.lock();
        if (failure) {
            if (!failure_) failure_ = failure;
            next_ = count_;
        }
        if (--running_ == 0 && next_ >= count_) done_.notify_all();
    }
}

void ThreadPool::run_worker() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!stopping_) {
        take_indices(lock);
        const int seen = calls_;
        lock.unlock();
        look_a_while([&] { return calls_ != seen; });
        lock.lock();
        wake_.wait(lock, [this] { return stopping_ || (work_ != nullptr && next_ < count_); });
    }
}

}  // namespace surefoot
