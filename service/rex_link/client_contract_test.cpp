// SPDX-License-Identifier: Apache-2.0
// The contract: if the machine moved, the gate gave two OKs to exactly these two questions, and
// each OK was still valid when it was used. Random schedules test it with a proxy between link and
// gate that does everything except forging. A witness compares the motions with the gate's true
// answers.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <queue>

#include "service/rex_link/answer_parser.hpp"
#include "service/rex_link/model_gate_testing.hpp"
#include "service/rex_link/rex_link.hpp"
#include "service/rex_link/unfaithful_proxy_testing.hpp"

namespace surefoot::rex_link {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kEnd_ns = 6'000 * kMs;

RexLinkConfig quick_steps() {
    RexLinkConfig config;
    config.step_duration_ns = 400 * kMs;
    return config;
}

/// A question that the link sent, and its fate.
struct Sent {
    std::uint64_t nonce = 0;
    Question question;
    std::int64_t sent_ns = 0;
    bool spoiled = false;  ///< the link received something that must end the attempt
};

/// Compares the actions of the link with the answers of the gate.
class Witness {
  public:
    void sent(std::uint64_t nonce, const Question& question, std::int64_t now_ns) {
        if (question.command != code_) fail("asks about what the joystick does not say");
        if (question.command == 0) fail("asks about the joystick at rest");
        if (refused_[question.command]) fail("asks again without a rest");
        if (now_ns < motion_end_ns_) fail("asks during a step");
        if (!sent_.empty() && question.sequence <= sent_.back().question.sequence)
            fail("a sequence does not grow");
        sent_.push_back({nonce, question, now_ns});
    }
    void said(const Said& said) { said_.push_back(said); }
    void joystick(std::uint8_t code, std::int64_t now_ns) {
        if (code == code_) return;
        spoil_attempt();
        if (code_ == 0 && now_ns - rest_since_ns_ >= RexLinkConfig{}.rest_pause_ns) refused_ = {};
        if (code == 0) rest_since_ns_ = now_ns;
        code_ = code;
    }
    void inhibited() {
        refused_[code_] = true;
        spoil_attempt();
    }
    void session(std::uint64_t nonce) {
        nonce_ = nonce;
        spoil_attempt();
    }
    /// The link received something that must end the current attempt.
    void spoil_attempt() {
        for (std::size_t i = sent_.size(); i > 0 && sent_.size() - i < 2; --i)
            sent_[i - 1].spoiled = true;
    }
    /// The link received a negative answer to this question.
    void spoil(std::uint64_t sequence) {
        for (Sent& sent : sent_)
            if (sent.question.sequence == sequence) sent.spoiled = true;
    }
    void acknowledged(std::int64_t now_ns) {
        if (sent_.empty() || fresh_oks(sent_.back(), now_ns).empty())
            fail("acknowledges without an OK");
    }
    void moved(const Motion& motion, std::int64_t now_ns) {
        ++motions;
        if (now_ns < motion_end_ns_) return fail("moves during a step");
        motion_end_ns_ = now_ns + motion.duration_ns;
        if (sent_.size() < 2) return fail("moves before two questions");
        const Sent& first = sent_[sent_.size() - 2];
        const Sent& second = sent_.back();
        if (motion.command != code_) fail("moves where the joystick does not point");
        for (const Sent* sent : {&first, &second}) {
            if (sent->question.command != motion.command) fail("moves elsewhere than asked");
            if (sent->nonce != nonce_) fail("moves on an answer of another session");
            if (sent->question.sequence <= used_) fail("uses an OK for two steps");
            if (sent->spoiled) fail("moves although something spoke against it");
        }
        const auto first_oks = fresh_oks(first, second.sent_ns);
        const auto second_oks = fresh_oks(second, now_ns);
        if (second_oks.empty()) fail("moves without a fresh second OK");
        if (first_oks.empty()) fail("moves without a first OK that lived when it asked again");
        const bool of_one_gate =
            std::find_first_of(
                first_oks.begin(), first_oks.end(), second_oks.begin(), second_oks.end()) !=
            first_oks.end();
        if (!of_one_gate) fail("moves on two gates' words");
        if (second.sent_ns - first.sent_ns < RexLinkConfig{}.second_question_delay_ns)
            fail("asks again without a delay");
        if (now_ns - second.sent_ns >= RexLinkConfig{}.answer_timeout_ns)
            fail("moves after silence");
        used_ = second.question.sequence;
    }

    std::uint64_t motions = 0;
    std::string first_failure;  ///< empty = the contract holds

  private:
    /// The connections that gave this question an OK that is still valid at `now_ns`, counted from
    /// the question. There may be several if the question arrived twice and the gate restarted in
    /// between.
    [[nodiscard]] std::vector<std::uint64_t> fresh_oks(const Sent& sent,
                                                       std::int64_t now_ns) const {
        std::vector<std::uint64_t> connections;
        for (const Said& said : said_) {
            if (said.ok && said.nonce == sent.nonce && said.sequence == sent.question.sequence &&
                said.command == sent.question.command && said.decided_ns >= sent.sent_ns &&
                now_ns >= said.decided_ns && now_ns - sent.sent_ns < said.life_ns) {
                connections.push_back(said.connection);
            }
        }
        return connections;
    }
    void fail(const char* what) {
        if (first_failure.empty()) first_failure = what;
    }

    std::vector<Sent> sent_;
    std::vector<Said> said_;
    std::array<bool, 256> refused_{};
    std::uint64_t nonce_ = 0;
    std::uint64_t used_ = 0;
    std::uint8_t code_ = 0;
    std::int64_t rest_since_ns_ = 0;
    std::int64_t motion_end_ns_ = 0;
};

/// One random schedule: a user, a link, a proxy, a gate and another client of the gate.
class Schedule {
  public:
    explicit Schedule(std::uint64_t seed)
        : rng_(seed),
          faithful_(rng_.below(10) == 0),
          held_(faithful_ || rng_.below(4) == 0),
          sleepy_(!faithful_ && rng_.below(8) == 0),
          proxy_(Rng(mix_seed(seed, 1)), faithful_),
          gate_(Rng(mix_seed(seed, 2)),
                faithful_ || rng_.below(3) > 0 ? 1.0 : rng_.uniform(),
                !faithful_) {}

    void run() {
        connect();
        push(1 * kMs);
        while (!events_.empty() && events_.top().time_ns < kEnd_ns) {
            const Event event = events_.top();
            events_.pop();
            now_ns_ = event.time_ns;
            happen(event);
        }
    }

    Witness witness;
    [[nodiscard]] bool faithful() const { return faithful_; }
    std::uint64_t questions = 0;

  private:
    enum class Kind { joystick, tick, to_gate, to_link, connect };
    struct Event {
        std::int64_t time_ns = 0;
        std::uint64_t order = 0;
        Kind kind = Kind::tick;
        Delivery delivery = {};
        Said said = {};  ///< for to_link: the answer that these bytes were made from
        bool operator<(const Event& other) const {
            return std::pair(other.time_ns, other.order) < std::pair(time_ns, order);
        }
    };

    std::int64_t some_ms(std::uint64_t most) {
        return static_cast<std::int64_t>(rng_.below(most * kMs));
    }
    void push(std::int64_t delay_ns) { add(delay_ns, Kind::joystick); }
    void add(std::int64_t delay_ns,
             Kind kind,
             const Delivery& delivery = {},
             const Said& said = {}) {
        events_.push({now_ns_ + delay_ns, ++order_, kind, delivery, said});
    }

    void happen(const Event& event) {
        switch (event.kind) {
            case Kind::joystick: return move_joystick();
            case Kind::tick: return obey(link_.tick(now_ns_));
            case Kind::to_gate: return ask_gate(event.delivery.bytes);
            case Kind::to_link: return tell_link(event);
            case Kind::connect: return connect();
        }
    }

    void move_joystick() {
        constexpr std::uint8_t kCodes[] = {0, 0, 9, 9, 17, 25, 200};
        const std::uint8_t code = held_ ? 9 : kCodes[rng_.below(7)];
        witness.joystick(code, now_ns_);
        obey(link_.joystick(code, now_ns_));
        if (!held_) push(rng_.below(3) == 0 ? some_ms(40) : some_ms(900));
    }

    void connect() {
        nonce_ = rng_.next_u64();
        connection_ = gate_.connect();
        connected_ = true;
        witness.session(nonce_);
        obey(link_.connected(nonce_, now_ns_));
    }

    /// The gate stops or restarts; the link may or may not notice.
    void break_something() {
        if (rng_.below(2) == 0) gate_.restart();
        connection_ = gate_.connect();
        if (rng_.below(2) == 0) return;  // hidden by the proxy
        if (connected_) add(some_ms(400), Kind::connect);
        connected_ = false;
        witness.session(0);
        obey(link_.disconnected(now_ns_));
    }

    void ask_gate(const std::string& bytes) {
        const Said said = gate_.answer(bytes, connection_, now_ns_);
        witness.said(said);
        send_to_link(said);
        if (proxy_.breaks()) break_something();
        if (proxy_.replays() && !old_.empty()) send_to_link(old_[rng_.below(old_.size())]);
        if (proxy_.replays()) send_to_link(answer_to_another());
        old_.push_back(said);
    }
    void send_to_link(const Said& said) {
        for (const Delivery& delivery : proxy_.pass(said.bytes))
            add(delivery.delay_ns, Kind::to_link, delivery, said);
    }

    /// Another client asks the same gate a similar question.
    Said answer_to_another() {
        const Question question{last_sequence_ + rng_.below(2), 9};
        return gate_.answer(format_question(rng_.next_u64(), question), gate_.connect(), now_ns_);
    }

    void tell_link(const Event& event) {
        const auto parsed = parse_answer(event.delivery.bytes);
        // A truncated answer, or an unchanged one of another session, must end the current attempt.
        // An unchanged negative answer must end the attempt of its question.
        const bool of_session = event.said.nonce == nonce_;
        if (event.delivery.truncated || (!event.delivery.altered && !of_session))
            witness.spoil_attempt();
        else if (!event.delivery.altered && !event.said.ok)
            witness.spoil(event.said.sequence);
        obey(parsed ? link_.answer(parsed.value().answer, now_ns_) : link_.damaged_answer(now_ns_));
    }

    void obey(const Actions& actions) {
        if (actions.inhibit) witness.inhibited();
        if (actions.tone == Tone::acknowledge) witness.acknowledged(now_ns_);
        if (actions.motion) witness.moved(*actions.motion, now_ns_);
        if (actions.question) {
            ++questions;
            last_sequence_ = actions.question->sequence;
            witness.sent(nonce_, *actions.question, now_ns_);
            for (const Delivery& delivery : proxy_.pass(format_question(nonce_, *actions.question)))
                add(delivery.delay_ns, Kind::to_gate, delivery);
        }
        if (const auto deadline_ns = link_.next_deadline_ns(); deadline_ns != deadline_ns_) {
            deadline_ns_ = deadline_ns;
            if (deadline_ns) add(*deadline_ns - now_ns_ + lateness_ns(), Kind::tick);
        }
    }
    std::int64_t lateness_ns() {
        if (faithful_) return 0;
        return sleepy_ && rng_.below(4) == 0 ? some_ms(500) : some_ms(3);
    }

    Rng rng_;
    bool faithful_;  ///< true if nothing goes wrong: the link must move
    bool held_;
    bool sleepy_;
    UnfaithfulProxy proxy_;
    ModelGate gate_;
    RexLink link_{quick_steps()};
    std::priority_queue<Event> events_;
    std::vector<Said> old_;
    std::optional<std::int64_t> deadline_ns_;
    std::int64_t now_ns_ = 0;
    std::uint64_t order_ = 0;
    std::uint64_t nonce_ = 0;
    std::uint64_t connection_ = 0;
    std::uint64_t last_sequence_ = 0;
    bool connected_ = false;
};

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
    const char* text = std::getenv(name);
    return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

// `make nightly` asks for 1e6 schedules of another seed.
TEST(ClientContract, MovedImpliesTwoFreshMatchingOks) {
    const std::uint64_t count = from_environment("SUREFOOT_CONTRACT_SCHEDULES", 20'000);
    const std::uint64_t seed = from_environment("SUREFOOT_CONTRACT_SEED", 21);
    std::uint64_t motions = 0, questions = 0, faithful = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        Schedule schedule(mix_seed(seed, i));
        schedule.run();
        ASSERT_EQ(schedule.witness.first_failure, "") << "seed " << seed << ", schedule " << i;
        motions += schedule.witness.motions;
        questions += schedule.questions;
        if (!schedule.faithful()) continue;
        ++faithful;
        // A cycle takes 400 ms of step, 150 ms of delay and four transfers of at most 2 ms; the
        // schedule lasts 6 s.
        EXPECT_GE(schedule.witness.motions, 10U) << "seed " << seed << ", schedule " << i;
    }
    std::printf("contract: seed %llu, %llu schedules, %llu questions, %llu motions, 0 violations\n",
                static_cast<unsigned long long>(seed),
                static_cast<unsigned long long>(count),
                static_cast<unsigned long long>(questions),
                static_cast<unsigned long long>(motions));
    EXPECT_GT(motions, count / 2) << "a link that never moves proves nothing";
    EXPECT_GT(faithful, count / 20);
}

}  // namespace
}  // namespace surefoot::rex_link
