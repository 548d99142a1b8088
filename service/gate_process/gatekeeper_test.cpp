// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/gatekeeper.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <vector>

#include "service/gate_process/outlook.hpp"
#include "surefoot/core/allocations_testing.hpp"
#include "surefoot/gate/gate_testing.hpp"

namespace surefoot::gate_process {
namespace {

using gate::Decision;
using gate::GateState;
using gate::Reason;
using gate::testing::kForward;
using gate::testing::kMs;

constexpr ChecksumKey kKey{3, 4};

/// Perception at 15 Hz on one side of a channel, the gatekeeper on the other, and their clock.
class GatekeeperTest : public ::testing::Test {
  protected:
    GatekeeperTest()
        : path_((std::filesystem::temp_directory_path() /
                 ("surefoot_gatekeeper_" + std::to_string(::getpid()) + "_" +
                  ::testing::UnitTest::GetInstance()->current_test_info()->name()))
                    .string()),
          map_(gate::testing::Terrain{}.snapshot()) {
        keep();
    }
    ~GatekeeperTest() override { std::filesystem::remove(path_); }

    void keep() {
        keeper_ = std::make_unique<Gatekeeper>(
            gate::testing::rex(),
            gate::ReadinessLimits{},
            ChannelAddress{path_, kKey},
            [this](const Judgement& judgement, const grid::MapSnapshot& map) {
                audited_.push_back(judgement);
                audited_versions_.push_back(map.version);
            },
            [this](const Act& act) { acts_.push_back(act); });
    }
    void start_perception() {
        writer_.reset();
        auto writer = SnapshotWriter::create({path_, kKey});
        ASSERT_TRUE(writer.ok()) << writer.error().message;
        writer_ = std::make_unique<SnapshotWriter>(std::move(*writer));
        map_->version = 0;
    }
    void publish() {
        ++map_->version;
        map_->frame_time_ns = map_->pose_time_ns = now_ns_ - 50 * kMs;
        gate::testing::seal(*map_);
        writer_->publish(*map_);
    }
    /// Polls every 5 ms; perception publishes every 65 ms unless it is gone.
    void run(double seconds, bool publishes = true) {
        const std::int64_t end_ns = now_ns_ + static_cast<std::int64_t>(seconds * 1e9);
        while (now_ns_ < end_ns) {
            now_ns_ += 5 * kMs;
            if (publishes && now_ns_ >= next_frame_ns_) {
                publish();
                next_frame_ns_ = now_ns_ + 65 * kMs;
            }
            keeper_->poll(now_ns_, now_ns_ + 17);
        }
    }
    void become_ready() {
        start_perception();
        run(3.0);
        ASSERT_EQ(keeper_->report(now_ns_).health.state, GateState::ready);
    }
    Answer ask(std::uint8_t command = kForward, std::uint64_t connection = 1) {
        return keeper_->ask_step({connection, ++sequence_, command}, now_ns_);
    }

    std::string path_;
    std::unique_ptr<grid::MapSnapshot> map_;
    std::unique_ptr<SnapshotWriter> writer_;
    std::unique_ptr<Gatekeeper> keeper_;
    std::vector<Judgement> audited_;
    std::vector<std::uint64_t> audited_versions_;
    std::vector<Act> acts_;
    std::int64_t now_ns_ = 100'000 * kMs;
    std::int64_t next_frame_ns_ = 0;
    std::uint64_t sequence_ = 0;
};

TEST_F(GatekeeperTest, without_perception_it_says_what_is_missing) {
    const Answer first = ask();  // before any poll
    EXPECT_EQ(first.verdict.decision, Decision::error);
    run(1.0, false);
    const Answer answer = ask();
    EXPECT_EQ(answer.verdict.decision, Decision::error);
    EXPECT_FALSE(answer.verdict.reasons.contains(Reason::internal)) << "nothing is damaged";
    EXPECT_TRUE(answer.verdict.reasons.contains(Reason::frame_stale));
    const GateReport report = keeper_->report(now_ns_);
    EXPECT_EQ(report.health.state, GateState::warmup);
    EXPECT_EQ(report.frame_age_ns, -1);
    EXPECT_NE(report.why, Reason::none);
    EXPECT_FALSE(keeper_->attest(1, 0.5, now_ns_).ok());
    EXPECT_EQ(keeper_->ask_goal({1, "odom", 1.0, 0.0, 0.0}, now_ns_).verdict.decision,
              Decision::error);
}

TEST_F(GatekeeperTest, when_ready_it_allows_a_step_on_the_newest_map_and_answers_to_whom_asked) {
    become_ready();
    publish();  // not polled yet
    const Answer answer = ask(kForward, 77);
    EXPECT_TRUE(answer.verdict.allows_step(now_ns_)) << gate::testing::words(answer.verdict);
    EXPECT_EQ(answer.verdict.map_version, map_->version);
    EXPECT_EQ(answer.verdict.connection, 77U);
    EXPECT_EQ(answer.verdict.sequence, sequence_);
    EXPECT_FALSE(answer.text.empty());
    const GateReport report = keeper_->report(now_ns_);
    EXPECT_EQ(report.why, Reason::none);
    EXPECT_EQ(report.frame_age_ns, 50 * kMs);
    EXPECT_EQ(report.asked, 1U);
    EXPECT_EQ(report.allowed, 1U);
}

TEST_F(GatekeeperTest, what_has_gone_from_the_newest_map_stops_nothing) {
    gate::testing::Terrain blocked;
    blocked.box(0.6, 0.8, -0.5, 0.5, 0.7);
    map_ = blocked.snapshot();
    become_ready();
    EXPECT_EQ(ask().verdict.decision, Decision::not_traversable);
    const std::uint64_t version = map_->version;
    map_ = gate::testing::Terrain{}.snapshot();
    map_->version = version;
    publish();  // not polled yet
    EXPECT_TRUE(ask().verdict.allows_step(now_ns_));
}

TEST_F(GatekeeperTest, a_sequence_must_grow_within_its_connection) {
    become_ready();
    const auto asked = [&](std::uint64_t connection, std::uint64_t sequence) {
        return keeper_->ask_step({connection, sequence, kForward}, now_ns_).verdict;
    };
    EXPECT_TRUE(asked(1, 5).allows_step(now_ns_));
    EXPECT_TRUE(asked(1, 5).reasons.contains(Reason::seq)) << "a copy of the question";
    EXPECT_TRUE(asked(1, 4).reasons.contains(Reason::seq));
    EXPECT_EQ(asked(1, 3).decision, Decision::error);
    EXPECT_TRUE(asked(2, 1).allows_step(now_ns_)) << "another connection counts for itself";
    EXPECT_TRUE(asked(1, 6).allows_step(now_ns_));
    keeper_->forget(1);
    EXPECT_TRUE(asked(1, 1).allows_step(now_ns_));
}

TEST_F(GatekeeperTest, a_perception_that_falls_silent_inhibits_within_a_quarter_of_a_second) {
    become_ready();
    ASSERT_TRUE(ask().verdict.allows_step(now_ns_));
    const std::int64_t last_ns = now_ns_;
    while (ask().verdict.allows_step(now_ns_)) run(0.005, false);
    EXPECT_LE(now_ns_ - last_ns, 250 * kMs);
    EXPECT_TRUE(ask().verdict.reasons.contains(Reason::frame_stale));
    run(0.5);
    EXPECT_FALSE(ask().verdict.allows_step(now_ns_)) << "released too soon";
    run(1.0);
    EXPECT_TRUE(ask().verdict.allows_step(now_ns_));
}

TEST_F(GatekeeperTest, a_new_perception_warms_up_again) {
    become_ready();
    start_perception();
    publish();
    EXPECT_FALSE(ask().verdict.allows_step(now_ns_));
    run(1.5);
    EXPECT_EQ(keeper_->report(now_ns_).health.state, GateState::warmup);
    run(1.0);
    EXPECT_TRUE(ask().verdict.allows_step(now_ns_));
}

TEST_F(GatekeeperTest, after_re_arming_the_old_map_is_not_believed) {
    become_ready();
    EXPECT_FALSE(keeper_->rearm(1, now_ns_).ok()) << "nothing to re-arm";
    map_->camera = CameraState::moved;
    publish();
    map_->camera = CameraState::ok;
    run(20.0);
    EXPECT_EQ(keeper_->report(now_ns_).health.state, GateState::fault);
    EXPECT_EQ(keeper_->report(now_ns_).why, Reason::mount_moved);
    ASSERT_TRUE(keeper_->rearm(1, now_ns_).ok());
    EXPECT_TRUE(writer_->restart_wanted());
    run(5.0);
    EXPECT_EQ(keeper_->report(now_ns_).health.state, GateState::warmup);
    EXPECT_FALSE(ask().verdict.allows_step(now_ns_));
    writer_->begin_anew();
    map_->version = 0;
    run(2.5);
    EXPECT_TRUE(ask().verdict.allows_step(now_ns_)) << gate::testing::words(ask().verdict);
}

TEST_F(GatekeeperTest, a_fault_outlives_the_process_that_found_it) {
    become_ready();
    map_->body_x_tenth_mm += 3'000;  // a jump
    run(1.0);
    ASSERT_EQ(keeper_->report(now_ns_).why, Reason::pose_jump);
    keep();  // killed, and started again
    run(5.0);
    EXPECT_EQ(keeper_->report(now_ns_).health.state, GateState::fault);
    EXPECT_EQ(keeper_->report(now_ns_).why, Reason::pose_jump);
    EXPECT_FALSE(ask().verdict.allows_step(now_ns_));
    ASSERT_TRUE(keeper_->rearm(1, now_ns_).ok());
    EXPECT_TRUE(writer_->restart_wanted()) << "its map is not believed again";
    writer_->begin_anew();
    map_->version = 0;
    run(3.0);
    EXPECT_TRUE(ask().verdict.allows_step(now_ns_)) << gate::testing::words(ask().verdict);
    keep();
    run(3.0);
    EXPECT_TRUE(ask().verdict.allows_step(now_ns_)) << "and it is over";
}

TEST_F(GatekeeperTest, a_gate_that_fails_its_self_test_cannot_be_re_armed) {
    Machine machine = gate::testing::rex();
    for (Movement& movement : machine.movements)  // next to no step: one canary finds no new ground
        movement.forward_tenth_mm = movement.left_tenth_mm = movement.forward_tenth_mm / 20;
    ASSERT_FALSE(std::make_unique<gate::Canaries>(machine)->judge_all().passed);
    keeper_ =
        std::make_unique<Gatekeeper>(machine, gate::ReadinessLimits{}, ChannelAddress{path_, kKey});
    start_perception();
    run(20.0);  // every canary has run
    ASSERT_EQ(keeper_->report(now_ns_).health.state, GateState::fault);
    const Status refused = keeper_->rearm(1, now_ns_);
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().message.find("self-test"), std::string::npos);
    EXPECT_EQ(keeper_->report(now_ns_).health.state, GateState::fault);
}

TEST_F(GatekeeperTest, an_operators_word_lasts_until_the_machine_has_left_or_a_fault) {
    gate::testing::Terrain blind;
    blind.box(-0.7, 0.7, -0.7, 0.7, std::nan(""));
    map_ = blind.snapshot();
    become_ready();
    EXPECT_EQ(ask().verdict.primary, Reason::unknown_cells);
    EXPECT_FALSE(keeper_->attest(1, 1.5, now_ns_).ok()) << "the machine file allows 1.0 m";
    EXPECT_FALSE(keeper_->attest(1, std::nan(""), now_ns_).ok());
    EXPECT_FALSE(keeper_->attest(1, -1.0, now_ns_).ok());
    EXPECT_FALSE(ask().verdict.allows_step(now_ns_));
    ASSERT_TRUE(keeper_->attest(1, 1.0, now_ns_).ok());
    EXPECT_TRUE(keeper_->report(now_ns_).attestation);
    EXPECT_EQ(keeper_->report(now_ns_).attested.radius_tenth_mm, 10'000);
    EXPECT_TRUE(ask().verdict.allows_step(now_ns_)) << gate::testing::words(ask().verdict);
    run(0.5);
    EXPECT_TRUE(ask().verdict.allows_step(now_ns_)) << "it lasts while the machine stands";
    map_->camera = CameraState::dark;
    publish();
    EXPECT_FALSE(keeper_->attest(1, 1.0, now_ns_).ok()) << "nobody knows where the machine is";
    map_->camera = CameraState::ok;
    run(1.5);
    ASSERT_TRUE(keeper_->attest(1, 1.0, now_ns_).ok());
    while (map_->body_x_tenth_mm < 10'100) {  // at half a metre a second
        map_->body_x_tenth_mm += 325;
        run(0.065);
    }
    EXPECT_FALSE(keeper_->report(now_ns_).attestation) << "the machine has left";
    EXPECT_FALSE(keeper_->report(now_ns_).attested.active);
    while (map_->body_x_tenth_mm > 0) {
        map_->body_x_tenth_mm -= 325;
        run(0.065);
    }
    EXPECT_EQ(keeper_->report(now_ns_).health.state, GateState::ready);
    EXPECT_FALSE(keeper_->report(now_ns_).attestation) << "and coming back revives nothing";
    ASSERT_TRUE(keeper_->attest(1, 1.0, now_ns_).ok());
    map_->camera = CameraState::moved;
    publish();
    run(0.01, false);
    EXPECT_FALSE(keeper_->report(now_ns_).attestation);
}

TEST_F(GatekeeperTest, an_attestation_too_small_for_the_soles_replaces_none) {
    become_ready();
    ASSERT_TRUE(keeper_->attest(1, 1.0, now_ns_).ok());
    for (const double radius_m : {0.00005, 0.0, 0.1, 0.3649, 1.5}) {
        const Status refused = keeper_->attest(2, radius_m, now_ns_);
        ASSERT_FALSE(refused.ok()) << radius_m;
        EXPECT_NE(refused.error().message.find("must be from 0.3650 m"), std::string::npos)
            << refused.error().message;
        EXPECT_TRUE(keeper_->report(now_ns_).attestation);
    }
    (void)ask();
    EXPECT_EQ(audited_.back().query.attested.radius_tenth_mm, 10'000);
    EXPECT_TRUE(keeper_->attest(2, 0.365, now_ns_).ok());
}

TEST_F(GatekeeperTest, the_starters_attestation_is_noted_and_does_not_replace_the_operators) {
    ASSERT_TRUE(keeper_->attest_when_ready(1.0).ok());
    start_perception();
    run(1.0);
    ASSERT_TRUE(keeper_->attest(7, 0.5, now_ns_).ok());
    run(2.0);
    ASSERT_EQ(keeper_->report(now_ns_).health.state, GateState::ready);
    (void)ask();
    EXPECT_EQ(audited_.back().query.attested.radius_tenth_mm, 5'000);
    EXPECT_TRUE(acts_.empty());
    keep();
    ASSERT_TRUE(keeper_->attest_when_ready(1.0).ok());
    run(3.0);
    ASSERT_EQ(acts_.size(), 1U);
    EXPECT_EQ(acts_[0].kind, ActKind::attest);
    EXPECT_EQ(acts_[0].outcome, ActOutcome::done);
    EXPECT_EQ(acts_[0].role, Role::operator_);
    EXPECT_EQ(acts_[0].connection, 0U);
    EXPECT_EQ(acts_[0].radius_tenth_mm, 10'000);
}

TEST_F(GatekeeperTest, nobody_fills_the_log_with_refusals) {
    Act refused;
    refused.time_ns = now_ns_;
    for (int i = 0; i < 1'000; ++i) keeper_->note(refused);
    EXPECT_EQ(acts_.size(), 100U);
    keeper_->note(act_of(ActKind::rearm, Role::operator_, 1, {}, now_ns_));
    ASSERT_EQ(acts_.size(), 101U) << "what was done is always noted";
    EXPECT_EQ(acts_.back().left_out, 900U);
    refused.time_ns += 100 * kMs;
    keeper_->note(refused);
    ASSERT_EQ(acts_.size(), 102U);
    EXPECT_EQ(acts_.back().left_out, 0U);
}

TEST_F(GatekeeperTest, whoever_starts_it_gives_their_word_once_and_after_a_fault_none) {
    const auto start_with_word = [this] {
        keep();
        ASSERT_TRUE(keeper_->attest_when_ready(1.0).ok());
    };
    EXPECT_FALSE(keeper_->attest_when_ready(1.5).ok()) << "the machine file allows 1.0 m";
    EXPECT_FALSE(keeper_->attest_when_ready(-1.0).ok());
    EXPECT_FALSE(keeper_->attest_when_ready(std::nan("")).ok());
    start_with_word();
    start_perception();
    run(0.5);
    EXPECT_FALSE(keeper_->report(now_ns_).attestation) << "the gate warms up";
    run(2.5);
    ASSERT_EQ(keeper_->report(now_ns_).health.state, GateState::ready);
    EXPECT_TRUE(keeper_->report(now_ns_).attestation);

    map_->body_x_tenth_mm += 3'000;  // a jump
    run(0.2);
    const auto re_arm = [this] {
        ASSERT_EQ(keeper_->report(now_ns_).health.state, GateState::fault);
        ASSERT_TRUE(keeper_->rearm(1, now_ns_).ok());
        writer_->begin_anew();
        map_->version = 0;
        run(3.0);
        ASSERT_EQ(keeper_->report(now_ns_).health.state, GateState::ready);
    };
    re_arm();
    EXPECT_FALSE(keeper_->report(now_ns_).attestation) << "it was given once";

    start_with_word();
    run(0.5);
    map_->camera = CameraState::moved;  // before the gate is first ready
    run(0.2);
    map_->camera = CameraState::ok;
    re_arm();
    EXPECT_FALSE(keeper_->report(now_ns_).attestation) << "where it stands now nobody answered for";
}

TEST_F(GatekeeperTest, goals_are_pictures_and_their_frame_must_be_known) {
    become_ready();
    const Answer good = keeper_->ask_goal({1, "odom", 1.0, -1.0, 0.3}, now_ns_);
    EXPECT_EQ(good.verdict.decision, Decision::ok) << gate::testing::words(good.verdict);
    EXPECT_FALSE(good.verdict.allows_step(now_ns_));
    EXPECT_EQ(keeper_->ask_goal({1, "map", 1.0, -1.0, 0.3}, now_ns_).verdict.primary,
              Reason::frame_id);
    const double nan = std::nan("");
    EXPECT_EQ(keeper_->ask_goal({1, "odom", nan, -1.0, 0.3}, now_ns_).verdict.primary,
              Reason::bad_number);
    EXPECT_EQ(keeper_->ask_goal({1, "odom", 1.0, -1.0, nan}, now_ns_).verdict.primary,
              Reason::bad_number);
}

TEST_F(GatekeeperTest, a_prospect_says_what_a_question_would_and_is_none) {
    gate::testing::Terrain blocked;
    blocked.box(0.6, 0.8, -0.5, 0.5, 0.7);
    map_ = blocked.snapshot();
    become_ready();
    ASSERT_EQ(keeper_->movements().size(), 26U);
    int allowed = 0;
    for (const std::uint8_t command : keeper_->movements()) {
        const Prospect prospect = keeper_->prospect_of(command, now_ns_);
        EXPECT_FALSE(prospect.verdict.allows_step(now_ns_)) << "a picture is no permission";
        EXPECT_EQ(prospect.verdict.connection, 0U);
        const GateReport before = keeper_->report(now_ns_);
        EXPECT_EQ(before.asked, 0U);
        EXPECT_EQ(before.allowed, 0U);
        EXPECT_TRUE(audited_.empty());
        allowed += prospect.verdict.decision == Decision::ok ? 1 : 0;
    }
    EXPECT_GT(allowed, 0);
    EXPECT_LT(allowed, 26);
    for (const std::uint8_t command : keeper_->movements()) {
        const Prospect prospect = keeper_->prospect_of(command, now_ns_);
        const Answer answer = keeper_->ask_step({0, ++sequence_, command}, now_ns_);
        EXPECT_EQ(prospect.verdict.decision, answer.verdict.decision) << int{command};
        EXPECT_EQ(prospect.verdict.reasons, answer.verdict.reasons);
        EXPECT_EQ(prospect.verdict.map_version, answer.verdict.map_version);
        EXPECT_EQ(keeper_->words_of(prospect), answer.text);
    }
}

TEST_F(GatekeeperTest, rounds_of_the_outlook_allocate_nothing_until_they_are_published) {
    become_ready();
    OutlookRounds rounds;
    const OutlookDemand listening{.subscribed = true, .question_waits = false};
    const std::size_t whole = keeper_->movements().size();
    const std::int64_t before = heap::allocations;
    for (std::size_t i = 0; i + 1 < whole; ++i)
        EXPECT_FALSE(rounds.next(*keeper_, listening, now_ns_));
    EXPECT_EQ(heap::allocations, before);
    EXPECT_TRUE(rounds.next(*keeper_, listening, now_ns_));
}

TEST_F(GatekeeperTest, every_verdict_is_audited_with_what_it_was_made_of) {
    become_ready();
    const Answer ok = ask();
    const Answer error = ask(0);
    ASSERT_EQ(audited_.size(), 2U);
    EXPECT_TRUE(audited_[0].verdict.allows_step(now_ns_));
    EXPECT_EQ(audited_[1].verdict.primary, Reason::unknown_command);
    EXPECT_EQ(audited_versions_[0], map_->version);
    for (const Judgement& j : audited_) {
        const gate::Verdict again =
            gate::decide(gate::testing::rex(), j.query, *map_, j.health, j.now_ns);
        EXPECT_EQ(again.reasons, j.verdict.reasons);
        EXPECT_EQ(again.evidence.cells, j.verdict.evidence.cells);
    }
}

TEST_F(GatekeeperTest, an_assured_gate_gives_no_ok_without_its_log) {
    become_ready();
    keeper_->set_log_failing(true);
    EXPECT_EQ(ask().verdict.primary, Reason::audit);
    EXPECT_EQ(keeper_->report(now_ns_).why, Reason::audit);
    keeper_->set_log_failing(false);
    EXPECT_TRUE(ask().verdict.allows_step(now_ns_));
}

// A map that another process wrote into the channel. It is sealed, but its checksum was made with
// another key.
TEST_F(GatekeeperTest, a_forged_map_is_a_fault_until_an_operator_re_arms) {
    become_ready();
    ASSERT_EQ(keeper_->channel_state(), ChannelState::open);
    {
        const std::string true_path = path_ + ".true";
        std::filesystem::rename(path_, true_path);
        auto forger = SnapshotWriter::create({path_, {kKey.low, kKey.high + 1}});
        ASSERT_TRUE(forger.ok());
        run(0.15, false);  // the gate opens the file that now has the name
        ++map_->version;
        map_->frame_time_ns = map_->pose_time_ns = now_ns_;
        gate::testing::seal(*map_);
        forger->publish(*map_);
        EXPECT_FALSE(ask().verdict.allows_step(now_ns_));
        std::filesystem::rename(true_path, path_);
    }
    EXPECT_EQ(keeper_->channel_state(), ChannelState::forged);
    EXPECT_EQ(keeper_->report(now_ns_).why, Reason::internal);
    run(4.0);
    EXPECT_EQ(keeper_->report(now_ns_).health.state, GateState::fault);
    EXPECT_FALSE(ask().verdict.allows_step(now_ns_));
    ASSERT_TRUE(keeper_->rearm(1, now_ns_).ok());
    writer_->begin_anew();
    run(4.0);
    EXPECT_TRUE(ask().verdict.allows_step(now_ns_));
    EXPECT_EQ(keeper_->channel_state(), ChannelState::open);
}

TEST_F(GatekeeperTest, a_lost_channel_is_opened_again_when_it_is_mended) {
    for (const bool deleted : {true, false}) {
        become_ready();
        if (deleted)
            std::filesystem::remove(path_);
        else
            std::filesystem::resize_file(path_, 10'000);
        run(0.01, false);
        EXPECT_EQ(keeper_->channel_state(), ChannelState::lost);
        run(0.5, false);
        EXPECT_FALSE(ask().verdict.allows_step(now_ns_)) << "its map is too old";
        EXPECT_EQ(keeper_->report(now_ns_).why, Reason::frame_stale);
        ASSERT_TRUE(writer_->mend()->has_value());
        run(2.0);
        EXPECT_EQ(keeper_->channel_state(), ChannelState::open);
        EXPECT_TRUE(ask().verdict.allows_step(now_ns_)) << "no fault, and no warm-up";
    }
}

// On a busy computer the gate may pause between reading the clock and reading the channel. A frame
// from that pause must not cost a warm-up.
TEST_F(GatekeeperTest, a_frame_that_came_since_the_look_at_the_clock_is_not_from_the_future) {
    become_ready();
    const auto publish_ahead = [&](std::int64_t ahead_ns) {
        ++map_->version;
        map_->frame_time_ns = map_->pose_time_ns = now_ns_ + ahead_ns;
        gate::testing::seal(*map_);
        writer_->publish(*map_);
    };
    publish_ahead(15 * kMs);  // more than the machine tolerates
    EXPECT_TRUE(ask().verdict.allows_step(now_ns_)) << "by the map of before";
    now_ns_ += 15 * kMs;  // the clock when the frame was read
    run(0.005, false);
    EXPECT_EQ(keeper_->report(now_ns_).health.state, GateState::ready);
    EXPECT_EQ(keeper_->report(now_ns_).map_version, map_->version) << "now it is here";
    // The next call detects a wrong stamp.
    publish_ahead(500 * kMs);
    run(0.01, false);
    EXPECT_EQ(keeper_->report(now_ns_).why, Reason::time_skew);
    EXPECT_FALSE(ask().verdict.allows_step(now_ns_));
}

TEST_F(GatekeeperTest, a_frame_that_waits_is_dropped_when_something_else_was_read) {
    become_ready();
    const std::uint64_t before = keeper_->report(now_ns_).map_version;
    ++map_->version;
    map_->frame_time_ns = map_->pose_time_ns = now_ns_ + 20 * kMs;
    gate::testing::seal(*map_);
    writer_->publish(*map_);
    keeper_->poll(now_ns_, now_ns_ + 17);  // the frame waits
    const std::string elsewhere = path_ + ".elsewhere";
    std::filesystem::rename(path_, elsewhere);
    now_ns_ += 5 * kMs;
    keeper_->poll(now_ns_, now_ns_ + 17);
    ASSERT_EQ(keeper_->channel_state(), ChannelState::lost);
    std::filesystem::rename(elsewhere, path_);
    run(0.15, false);
    ASSERT_EQ(keeper_->channel_state(), ChannelState::open);
    EXPECT_EQ(keeper_->report(now_ns_).map_version, before);
}

TEST_F(GatekeeperTest, after_stopping_nothing_is_ok) {
    become_ready();
    keeper_->stop();
    EXPECT_FALSE(ask().verdict.allows_step(now_ns_));
    run(5.0);
    EXPECT_FALSE(ask().verdict.allows_step(now_ns_));
    EXPECT_FALSE(keeper_->rearm(1, now_ns_).ok());
}

TEST_F(GatekeeperTest, a_machine_that_is_not_valid_never_allows_anything) {
    keeper_ = std::make_unique<Gatekeeper>(
        Machine{}, gate::ReadinessLimits{}, ChannelAddress{path_, kKey});
    start_perception();
    run(5.0);
    EXPECT_EQ(ask().verdict.decision, Decision::error);
    EXPECT_EQ(keeper_->report(now_ns_).health.state, GateState::fault);
}

TEST_F(GatekeeperTest, a_computer_that_slept_is_a_fault) {
    become_ready();
    keeper_->poll(now_ns_ + 5 * kMs, now_ns_ + 5 * kMs + 17 + 3'000 * kMs);
    EXPECT_EQ(keeper_->report(now_ns_ + 5 * kMs).why, Reason::clock);
}

}  // namespace
}  // namespace surefoot::gate_process
