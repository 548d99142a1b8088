// SPDX-License-Identifier: Apache-2.0
// No verdict waits for a disk, and dropped verdicts are counted at their position in the log.
#include "service/gate_process/audit/audit_log.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "service/gate_process/audit/audit_testing.hpp"
#include "service/gate_process/audit/memory_disk_testing.hpp"
#include "surefoot/core/allocation_counts_testing.hpp"

namespace surefoot::gate_process::testing {
namespace {

AuditConfig small_config() {
    AuditConfig config;
    config.files = {.run_id = 9, .file_bytes = 1'000'000, .total_bytes = 100'000'000};
    config.memory_bytes = 3 * (kMaxRecordBytes + 64);
    config.poll_ns = 1'000'000;
    config.retry_ns = 1'000'000;
    return config;
}

/// Counts the verdicts that their records reproduce.
AuditReader::OnVerdict count_equal(std::uint64_t& equal) {
    return [&equal](const AuditedAt& at) {
        if (differences(at.record.verdict, replay(at.machine, at.record)).empty()) ++equal;
    };
}

struct Bench {
    std::shared_ptr<Platter> platter = std::make_shared<Platter>();
    Rng rng{23};
    std::vector<Case> cases;
    AuditLog log{rex(), std::make_unique<MemoryDisk>(platter), small_config()};

    Bench() {
        for (int i = 0; i < 8; ++i) cases.push_back(random_case(rng));
    }
    void push(int count) {
        for (int i = 0; i < count; ++i)
            log.push(cases[static_cast<std::size_t>(i) % cases.size()].audited());
    }
    void hang() {
        platter->set([](Platter& p) { p.hangs = true; });
    }
    void release() {
        platter->set([](Platter& p) { p.hangs = false; });
    }
    /// Waits for the thread of the log, without a limit of time.
    template <typename Condition>
    void await(Condition condition) {
        while (!condition()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
};

TEST(AuditLog, every_verdict_comes_out_of_the_log_again) {
    Bench bench;
    ASSERT_TRUE(bench.log.start());
    bench.push(40);
    bench.log.stop();
    std::uint64_t equal = 0;
    const AuditSummary summary = bench.platter->read(count_equal(equal));
    EXPECT_FALSE(summary.damage) << summary.damage->text();
    EXPECT_EQ(summary.verdicts, 40U);
    EXPECT_EQ(equal, 40U);
    EXPECT_EQ(summary.gaps, 0U);
    EXPECT_EQ(bench.log.report().written, 40U);
    EXPECT_EQ(bench.log.report().lost, 0U);
    EXPECT_GT(bench.platter->syncs, 0);
}

TEST(AuditLog, acts_stand_between_the_verdicts_in_their_order) {
    Bench bench;
    ASSERT_TRUE(bench.log.start());
    bench.push(2);
    bench.log.push(act_of(ActKind::attest, Role::operator_, 4, {}, kNowNs, 0.5));
    bench.push(1);
    Act refused = act_of(ActKind::rearm, Role::rider, 5, {}, kNowNs);
    refused.outcome = ActOutcome::no_right;
    bench.log.push(refused);
    bench.log.stop();
    std::vector<std::string> order;
    const AuditSummary summary =
        bench.platter->read([&](const AuditedAt&) { order.emplace_back("verdict"); },
                            [&](const Act& act) {
                                order.push_back(std::string(to_string(act.role)) + " " +
                                                to_string(act.kind) + " " + to_string(act.outcome));
                            });
    EXPECT_FALSE(summary.damage) << summary.damage->text();
    EXPECT_EQ(
        order,
        (std::vector<std::string>{
            "verdict", "verdict", "operator attest done", "verdict", "rider re-arm no right"}));
    EXPECT_EQ(summary.acts, 2U);
    EXPECT_EQ(summary.verdicts, 3U);
}

TEST(AuditLog, a_disk_that_hangs_delays_nothing_and_the_gap_is_in_the_log) {
    Bench bench;
    bench.cases.resize(1);  // records of one size: if one does not fit, no other fits
    bench.hang();
    ASSERT_TRUE(bench.log.start());
    EXPECT_EQ(bench.log.state(kNowNs), AuditState::ok);
    constexpr int kPushed = 500;
    bench.push(kPushed);  // must return although the disk has not taken a byte
    const std::uint64_t lost = bench.log.report().lost;
    EXPECT_GT(lost, 100U);
    EXPECT_LT(lost, static_cast<std::uint64_t>(kPushed) - 20U);
    EXPECT_EQ(bench.log.state(kNowNs), AuditState::behind);
    bench.release();
    bench.await([&] { return bench.log.report().written == kPushed - lost; });
    bench.push(3);  // the gap stands before these
    bench.log.stop();
    std::uint64_t equal = 0;
    const AuditSummary summary = bench.platter->read(count_equal(equal));
    EXPECT_FALSE(summary.damage) << summary.damage->text();
    EXPECT_EQ(summary.verdicts, kPushed - lost + 3);
    EXPECT_EQ(equal, summary.verdicts);
    EXPECT_EQ(summary.gaps, 1U);
    EXPECT_EQ(summary.lost, lost);
}

TEST(AuditLog, a_gap_is_written_once_though_the_verdict_after_it_had_to_wait) {
    Bench bench;
    bench.cases.resize(1);  // records of one size: if one does not fit, no other fits
    bench.hang();
    ASSERT_TRUE(bench.log.start());
    bench.push(500);
    const std::uint64_t lost = bench.log.report().lost;
    bench.release();
    bench.await([&] { return bench.log.report().written == 500 - lost; });
    constexpr std::uint64_t kGapFits = 200;  // room for gap entries, but for no verdict
    bench.platter->set([](Platter& p) { p.room = p.used() + kGapFits; });
    bench.push(1);
    bench.await([&] { return bench.log.state(kNowNs) == AuditState::failing; });
    bench.platter->set([](Platter& p) { p.room = 100'000'000; });
    bench.log.stop();
    const AuditSummary summary = bench.platter->read();
    EXPECT_EQ(summary.gaps, 1U);
    EXPECT_EQ(summary.lost, lost);
    EXPECT_EQ(summary.verdicts, 501 - lost);
}

TEST(AuditLog, a_gap_at_the_end_is_written_when_the_log_stops) {
    Bench bench;
    bench.cases.resize(1);  // records of one size: if one does not fit, no other fits
    bench.hang();
    ASSERT_TRUE(bench.log.start());
    bench.push(500);
    const std::uint64_t lost = bench.log.report().lost;
    ASSERT_GT(lost, 0U);
    bench.release();
    bench.log.stop();
    const AuditSummary summary = bench.platter->read();
    EXPECT_EQ(summary.lost, lost);
    EXPECT_EQ(summary.verdicts, 500 - lost);
}

TEST(AuditLog, a_slow_disk_is_behind_after_its_time_and_ok_when_it_caught_up) {
    Bench bench;
    bench.hang();
    ASSERT_TRUE(bench.log.start());
    bench.push(1);
    constexpr std::int64_t kSecondNs = 1'000'000'000;
    EXPECT_EQ(bench.log.state(kNowNs + kSecondNs), AuditState::ok);
    EXPECT_EQ(bench.log.state(kNowNs + 5 * kSecondNs), AuditState::behind);  // 5 s slow
    bench.release();
    bench.await([&] { return bench.log.report().written == 1; });
    bench.await([&] { return bench.log.state(kNowNs + 5 * kSecondNs) == AuditState::ok; });
    bench.log.stop();
    EXPECT_EQ(bench.platter->read().verdicts, 1U);
}

TEST(AuditLog, a_full_disk_is_failing_and_nothing_is_lost_that_the_memory_held) {
    Bench bench;
    bench.platter->room = 3000;
    ASSERT_TRUE(bench.log.start());
    bench.push(30);
    bench.await([&] { return bench.log.state(kNowNs) == AuditState::failing; });
    EXPECT_NE(bench.log.report().last_error.find("No space left"), std::string::npos);
    bench.platter->set([](Platter& p) { p.room = 100'000'000; });
    bench.await([&] { return bench.log.report().written == 30; });
    bench.await([&] { return bench.log.state(kNowNs) == AuditState::ok; });
    bench.log.stop();
    const AuditSummary summary = bench.platter->read();
    EXPECT_FALSE(summary.damage) << summary.damage->text();
    EXPECT_EQ(summary.verdicts, 30U);
    EXPECT_EQ(summary.gaps, 0U);
}

TEST(AuditLog, a_disk_that_cannot_sync_is_failing_until_it_can) {
    Bench bench;
    bench.platter->fails_sync = true;
    AuditConfig config = small_config();
    config.sync_ns = 1;
    AuditLog log(rex(), std::make_unique<MemoryDisk>(bench.platter), config);
    ASSERT_TRUE(log.start());
    log.push(bench.cases[0].audited());
    bench.await([&] { return log.state(kNowNs) == AuditState::failing; });
    bench.platter->set([](Platter& p) { p.fails_sync = false; });
    bench.await([&] { return log.state(kNowNs) == AuditState::ok; });
    log.stop();
    EXPECT_FALSE(bench.platter->read().damage);
}

TEST(AuditLog, a_folder_that_cannot_be_written_is_failing_though_nobody_asks) {
    Bench bench;
    bench.platter->fails_create = true;
    AuditConfig config = small_config();
    config.sync_ns = 1;  // an absent file is synced at once
    AuditLog log(rex(), std::make_unique<MemoryDisk>(bench.platter), config);
    ASSERT_TRUE(log.start());
    const auto tries = [&] {
        const std::lock_guard lock(bench.platter->mutex);
        return bench.platter->creates;
    };
    bench.await([&] { return tries() > 0 && log.state(kNowNs) == AuditState::failing; });
    bench.await([&] { return tries() > 5 || log.state(kNowNs) != AuditState::failing; });
    EXPECT_EQ(log.state(kNowNs), AuditState::failing);
    bench.platter->set([](Platter& p) { p.fails_create = false; });
    bench.await([&] { return log.state(kNowNs) == AuditState::ok; });
}

TEST(AuditLog, stops_on_a_disk_that_takes_nothing_and_counts_all_as_lost) {
    Bench bench;
    bench.platter->write_error = EIO;
    ASSERT_TRUE(bench.log.start());
    bench.push(10);
    bench.log.stop();
    EXPECT_EQ(bench.log.report().lost, 10U);
    EXPECT_EQ(bench.log.report().written, 0U);
    EXPECT_TRUE(bench.log.report().failing);
    EXPECT_EQ(bench.platter->read().verdicts, 0U);
}

TEST(AuditLog, without_a_start_it_is_failing_and_counts) {
    Bench bench;
    bench.push(2);
    EXPECT_EQ(bench.log.report().lost, 2U);
    EXPECT_EQ(bench.log.state(kNowNs), AuditState::failing);
    AuditConfig config = small_config();
    config.memory_bytes = 1000;
    AuditLog refused(rex(), std::make_unique<MemoryDisk>(bench.platter), config);
    EXPECT_FALSE(refused.start());
}

TEST(AuditLog, push_allocates_nothing) {
    Bench bench;
    bench.hang();
    ASSERT_TRUE(bench.log.start());
    const std::int64_t before = heap::allocations_here;
    bench.push(500);  // with room and without
    static_cast<void>(bench.log.state(kNowNs));
    EXPECT_EQ(heap::allocations_here, before);
    bench.release();
}

/// A folder of the file system with a size limit per file.
class SystemLimit {
  public:
    explicit SystemLimit(rlim_t bytes) {
        before_signal_ = std::signal(SIGXFSZ, SIG_IGN);
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit now{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &now);
    }
    SystemLimit(const SystemLimit&) = delete;
    SystemLimit& operator=(const SystemLimit&) = delete;
    ~SystemLimit() { lift(); }
    void lift() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, before_signal_);
    }

  private:
    rlimit before_{};
    void (*before_signal_)(int) = SIG_DFL;
};

TEST(AuditLog, goes_on_after_a_limit_of_the_system_itself) {
    namespace fs = std::filesystem;
    const fs::path folder =
        fs::temp_directory_path() / ("audit_log_test_" + std::to_string(::getpid()));
    fs::remove_all(folder);
    Bench bench;
    AuditLog log(rex(), make_folder_disk(folder.string()), small_config());
    {
        SystemLimit limit(20'000);
        ASSERT_TRUE(log.start());
        for (const Case& c : bench.cases) log.push(c.audited());
        bench.await([&] { return log.state(kNowNs) == AuditState::failing; });
    }
    bench.await([&] { return log.report().written == bench.cases.size(); });
    log.stop();
    std::uint64_t equal = 0;
    const auto summary = read_audit(folder.string(), count_equal(equal));
    ASSERT_TRUE(summary) << summary.error().message;
    EXPECT_FALSE(summary->damage) << summary->damage->text();
    EXPECT_EQ(equal, bench.cases.size());
    fs::remove_all(folder);
}

}  // namespace
}  // namespace surefoot::gate_process::testing
