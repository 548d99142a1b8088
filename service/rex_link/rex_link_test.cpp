// SPDX-License-Identifier: Apache-2.0
#include "service/rex_link/rex_link.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace surefoot::rex_link {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::uint64_t kNonce = 0xabcd;
constexpr std::uint64_t kConnection = 7;
constexpr std::uint8_t kAhead = 9, kBack = 17;
const RexLinkConfig kConfig;

Answer ok_to(const Question& question) {
    return {kNonce, kConnection, question.sequence, question.command, AnswerVerdict::ok, 300 * kMs};
}

/// A connected link whose joystick has been at rest for long.
class RexLinkTest : public ::testing::Test {
  protected:
    void SetUp() override { EXPECT_FALSE(link_.connected(kNonce, now_ns_).question); }

    Actions push(std::uint8_t code) { return link_.joystick(code, now_ns_); }
    Actions say(const Answer& answer) { return link_.answer(answer, now_ns_); }
    Actions after_ms(std::int64_t ms) {
        now_ns_ += ms * kMs;
        return link_.tick(now_ns_);
    }
    /// The question that follows from pushing the joystick.
    Question asked(std::uint8_t code = kAhead) {
        const Actions actions = push(code);
        EXPECT_TRUE(actions.question) << "code " << int{code} << " is not asked";
        return actions.question.value_or(Question{});
    }
    /// The second question, after an OK to the first one.
    Question asked_again(std::uint8_t code = kAhead) {
        const Actions heard = say(ok_to(asked(code)));
        EXPECT_EQ(heard.tone, Tone::acknowledge);
        const Actions actions = after_ms(150);
        EXPECT_TRUE(actions.question);
        return actions.question.value_or(Question{});
    }
    static void expect_inhibit(const Actions& actions, Inhibit why) {
        ASSERT_TRUE(actions.inhibit) << "expected " << to_string(why);
        EXPECT_STREQ(to_string(*actions.inhibit), to_string(why));
        EXPECT_EQ(actions.tone,
                  why == Inhibit::not_traversable ? Tone::not_traversable : Tone::cannot_judge);
        EXPECT_FALSE(actions.motion);
        EXPECT_FALSE(actions.question);
    }
    static void expect_nothing(const Actions& actions) {
        EXPECT_FALSE(actions.question || actions.tone || actions.motion || actions.inhibit);
    }

    std::int64_t now_ns_ = 1000 * kMs;
    RexLink link_{kConfig};
};

TEST_F(RexLinkTest, MovesOnTheSecondOkAndNotOnTheFirst) {
    const Question first = asked();
    EXPECT_EQ(first.command, kAhead);
    const Actions heard = say(ok_to(first));
    EXPECT_EQ(heard.tone, Tone::acknowledge);
    EXPECT_FALSE(heard.motion || heard.question || heard.inhibit);
    expect_nothing(after_ms(149));
    const Actions again = after_ms(1);
    ASSERT_TRUE(again.question);
    EXPECT_EQ(again.question->sequence, first.sequence + 1);
    EXPECT_EQ(again.question->command, kAhead);
    EXPECT_FALSE(again.motion || again.tone);
    const Actions allowed = say(ok_to(*again.question));
    ASSERT_TRUE(allowed.motion);
    EXPECT_EQ(allowed.motion->command, kAhead);
    EXPECT_EQ(allowed.motion->duration_ns, kConfig.step_duration_ns);
    EXPECT_FALSE(allowed.tone || allowed.question || allowed.inhibit);
}

TEST_F(RexLinkTest, NothingIsAskedAtRest) {
    expect_nothing(push(0));
    expect_nothing(after_ms(1000));
}

TEST_F(RexLinkTest, ANoToEitherQuestionIsTheToneOfNotTraversable) {
    Answer no = ok_to(asked());
    no.verdict = AnswerVerdict::not_traversable;
    expect_inhibit(say(no), Inhibit::not_traversable);
    push(0);
    after_ms(200);
    no = ok_to(asked_again());
    no.verdict = AnswerVerdict::not_traversable;
    expect_inhibit(say(no), Inhibit::not_traversable);
}

TEST_F(RexLinkTest, ErrorAndUnknownVerdictsCannotJudge) {
    for (const int code : {0, 3, 255}) {
        Answer answer = ok_to(asked());
        answer.verdict = static_cast<AnswerVerdict>(code);
        expect_inhibit(say(answer), Inhibit::gate_error);
        push(0);
        after_ms(200);
    }
}

TEST_F(RexLinkTest, AnswersThatFitNoQuestionInhibit) {
    const std::function<void(Answer&)> damages[] = {[](Answer& a) { ++a.nonce; },
                                                    [](Answer& a) { ++a.sequence; },
                                                    [](Answer& a) { a.command = kBack; },
                                                    [](Answer& a) { a.connection = 0; }};
    for (const auto& damage : damages) {
        for (const bool second : {false, true}) {
            Answer answer = ok_to(second ? asked_again() : asked());
            damage(answer);
            expect_inhibit(say(answer), Inhibit::mismatch);
            push(0);
            after_ms(200);
        }
    }
}

TEST_F(RexLinkTest, BothAnswersComeFromOneConnectionOfTheGate) {
    Answer answer = ok_to(asked_again());
    answer.connection = kConnection + 1;
    expect_inhibit(say(answer), Inhibit::mismatch);
    push(0);
    after_ms(200);
    const Question first = asked();  // after a restart of the gate its new connection is accepted
    answer = ok_to(first);
    answer.connection = kConnection + 1;
    EXPECT_EQ(say(answer).tone, Tone::acknowledge);
}

TEST_F(RexLinkTest, SilenceInhibitsAtItsLimit) {
    asked();
    expect_nothing(after_ms(99));
    expect_inhibit(after_ms(1), Inhibit::silence);
    push(0);
    after_ms(200);
    asked_again();
    expect_nothing(after_ms(99));
    expect_inhibit(after_ms(1), Inhibit::silence);
}

TEST_F(RexLinkTest, AnAnswerAtTheLimitOfSilenceIsTooLateEvenIfNobodyLookedAtTheClock) {
    const Answer late = ok_to(asked());
    now_ns_ += 100 * kMs;
    expect_inhibit(say(late), Inhibit::silence);
    push(0);
    after_ms(200);
    const Answer in_time = ok_to(asked());
    now_ns_ += 100 * kMs - 1;
    EXPECT_EQ(say(in_time).tone, Tone::acknowledge);
}

TEST_F(RexLinkTest, LifeCountsFromTheQuestionNotFromTheArrival) {
    for (const bool second : {false, true}) {
        Answer answer = ok_to(second ? asked_again() : asked());
        answer.valid_for_ns = 40 * kMs;
        now_ns_ += 40 * kMs;
        expect_inhibit(say(answer), Inhibit::expired);
        push(0);
        after_ms(200);
    }
    Answer answer = ok_to(asked_again());
    answer.valid_for_ns = 40 * kMs;
    now_ns_ += 40 * kMs - 1;
    EXPECT_TRUE(say(answer).motion);
}

TEST_F(RexLinkTest, NoLifeOrALongerOneThanAnyVerdictHasInhibits) {
    for (const std::int64_t life_ns : {std::int64_t{0}, -kMs, std::int64_t{INT64_MIN}}) {
        Answer answer = ok_to(asked());
        answer.valid_for_ns = life_ns;
        expect_inhibit(say(answer), Inhibit::expired);
        push(0);
        after_ms(200);
    }
    Answer answer = ok_to(asked());
    answer.valid_for_ns = 300 * kMs + 1;
    expect_inhibit(say(answer), Inhibit::damaged);
}

TEST_F(RexLinkTest, TheFirstOkMustLiveWhenTheSecondQuestionIsAsked) {
    Answer first = ok_to(asked());
    now_ns_ += 10 * kMs;
    first.valid_for_ns = 160 * kMs;  // ends just when the second question is due
    EXPECT_EQ(say(first).tone, Tone::acknowledge);
    expect_inhibit(after_ms(150), Inhibit::expired);
    push(0);
    after_ms(200);
    first = ok_to(asked());
    now_ns_ += 10 * kMs;
    first.valid_for_ns = 160 * kMs + 1;
    say(first);
    EXPECT_TRUE(after_ms(150).question);
    push(0);
    after_ms(200);
    say(ok_to(asked()));
    expect_inhibit(after_ms(300), Inhibit::expired);  // the caller was late
}

TEST_F(RexLinkTest, ADuplicateCountsOnce) {
    const Question first = asked();
    say(ok_to(first));
    expect_nothing(say(ok_to(first)));
    const Actions again = after_ms(150);
    ASSERT_TRUE(again.question);
    expect_nothing(say(ok_to(first)));  // an OK to the first question does not count for the second
    const Actions allowed = say(ok_to(*again.question));
    ASSERT_TRUE(allowed.motion);
    expect_nothing(say(ok_to(*again.question)));
}

TEST_F(RexLinkTest, ANoThatFollowsAnOkToTheSameQuestionInhibits) {
    for (const bool after_the_second_question : {false, true}) {
        Answer answer = ok_to(asked());
        say(answer);
        if (after_the_second_question) after_ms(150);
        answer.verdict = AnswerVerdict::not_traversable;
        expect_inhibit(say(answer), Inhibit::not_traversable);
        push(0);
        after_ms(200);
    }
}

TEST_F(RexLinkTest, LateAnswersOfEndedAttemptsMeanNothing) {
    const Question dropped = asked();
    push(0);
    Answer late = ok_to(dropped);
    expect_nothing(say(late));
    const Question present = asked(kBack);
    expect_nothing(say(late));
    late.verdict = AnswerVerdict::not_traversable;
    expect_nothing(say(late));
    EXPECT_EQ(say(ok_to(present)).tone, Tone::acknowledge);
    late.nonce = kNonce + 1;  // a replayed old answer of another session
    expect_inhibit(say(late), Inhibit::mismatch);
}

TEST_F(RexLinkTest, DamagedBytesInhibitWhileAQuestionIsOpenOrAcknowledged) {
    asked();
    expect_inhibit(link_.damaged_answer(now_ns_), Inhibit::damaged);
    push(0);
    after_ms(200);
    say(ok_to(asked()));
    expect_inhibit(link_.damaged_answer(now_ns_), Inhibit::damaged);
    push(0);
    after_ms(200);
    asked_again();
    expect_inhibit(link_.damaged_answer(now_ns_), Inhibit::damaged);
    push(0);
    expect_nothing(link_.damaged_answer(now_ns_));
}

TEST_F(RexLinkTest, AnotherDirectionOrRestCancels) {
    const Question first = asked();
    const Actions turned = push(kBack);
    EXPECT_FALSE(turned.tone || turned.inhibit || turned.motion);
    ASSERT_TRUE(turned.question);
    EXPECT_EQ(turned.question->command, kBack);
    EXPECT_EQ(turned.question->sequence, first.sequence + 1);
    say(ok_to(*turned.question));
    expect_nothing(push(0));
    expect_nothing(after_ms(150));  // no second question
    const Question second = asked_again();
    expect_nothing(push(0));
    expect_nothing(say(ok_to(second)));
    expect_nothing(after_ms(10'000));
}

TEST_F(RexLinkTest, ARepeatedJoystickCodeChangesNothing) {
    say(ok_to(asked()));
    expect_nothing(push(kAhead));
    EXPECT_TRUE(after_ms(150).question);
    expect_nothing(push(kAhead));
}

TEST_F(RexLinkTest, EveryStepOfAHeldJoystickNeedsTwoOksOfItsOwn) {
    ASSERT_TRUE(say(ok_to(asked_again())).motion);
    expect_nothing(after_ms(9'999));
    for (int step = 0; step < 3; ++step) {
        const Actions first = after_ms(step == 0 ? 1 : 10'000);
        ASSERT_TRUE(first.question) << "step " << step;
        const Actions heard = say(ok_to(*first.question));
        EXPECT_FALSE(heard.motion);
        EXPECT_EQ(heard.tone, Tone::acknowledge);
        const Actions second = after_ms(150);
        ASSERT_TRUE(second.question);
        ASSERT_TRUE(say(ok_to(*second.question)).motion);
    }
}

TEST_F(RexLinkTest, NothingIsAskedOrSaidWhileAStepIsUnderWay) {
    const Question second = asked_again();
    ASSERT_TRUE(say(ok_to(second)).motion);
    Answer no = ok_to(second);
    no.verdict = AnswerVerdict::not_traversable;
    expect_nothing(say(no));
    expect_nothing(link_.damaged_answer(now_ns_));
    expect_nothing(push(kBack));
    expect_nothing(link_.disconnected(now_ns_));
    expect_nothing(link_.connected(kNonce, now_ns_));
    EXPECT_EQ(link_.state(), LinkState::stepping);
    const Actions next = after_ms(10'000);  // a question about the current code
    ASSERT_TRUE(next.question);
    EXPECT_EQ(next.question->command, kBack);
}

TEST_F(RexLinkTest, ARefusedDirectionIsAskedAgainOnlyAfterTheJoystickRested) {
    asked();
    after_ms(100);
    expect_nothing(after_ms(60'000));  // while it is held, no further question
    expect_nothing(push(0));
    after_ms(199);
    expect_nothing(push(kAhead));  // too short a rest
    push(0);
    EXPECT_TRUE(push(kBack).question) << "another direction needs no rest";
    expect_nothing(push(kAhead));
    push(0);
    after_ms(200);
    EXPECT_TRUE(push(kAhead).question);
}

TEST_F(RexLinkTest, RestCountsFromTheLastReturnAndThroughAStep) {
    asked();
    after_ms(100);
    push(0);
    after_ms(199);
    push(kBack);
    push(0);
    after_ms(199);
    expect_nothing(push(kAhead));
    push(0);
    after_ms(100);
    push(0);  // still at rest
    after_ms(100);
    EXPECT_TRUE(push(kAhead).question);
}

TEST_F(RexLinkTest, TheConnectionsEndInhibits) {
    asked();
    expect_inhibit(link_.disconnected(now_ns_), Inhibit::disconnected);
    push(0);
    after_ms(200);
    expect_inhibit(push(kAhead), Inhibit::disconnected);
    push(0);
    after_ms(200);
    expect_nothing(link_.connected(kNonce, now_ns_));
    say(ok_to(asked()));
    expect_inhibit(link_.connected(kNonce + 1, now_ns_), Inhibit::disconnected);
    push(0);
    after_ms(200);
    expect_inhibit(say(ok_to(asked())), Inhibit::mismatch);  // an answer of the previous session
}

TEST_F(RexLinkTest, SequencesGrowOverConnections) {
    const Question before = asked();
    expect_inhibit(link_.disconnected(now_ns_), Inhibit::disconnected);
    push(0);
    after_ms(200);
    expect_nothing(link_.connected(kNonce + 1, now_ns_));
    EXPECT_GT(asked().sequence, before.sequence);
    EXPECT_GT(before.sequence, 0U);
}

TEST_F(RexLinkTest, CodesThatAreNoMovementAreNeverAsked) {
    for (int code = 1; code < 256; ++code) {
        const Actions actions = push(static_cast<std::uint8_t>(code));
        if (code <= 26) {
            EXPECT_TRUE(actions.question) << code;
        } else {
            expect_inhibit(actions, Inhibit::unknown_code);
        }
        push(0);
        after_ms(200);
    }
}

TEST_F(RexLinkTest, TimeThatGoesBackwardsInhibits) {
    asked();
    now_ns_ -= 1;
    expect_inhibit(link_.tick(now_ns_), Inhibit::clock);
    push(0);
    after_ms(200);
    const Question second = asked_again();
    now_ns_ -= 1;
    expect_inhibit(say(ok_to(second)), Inhibit::clock);
    push(0);
    after_ms(500);
    after_ms(-400);  // the duration of the rest is unknown now
    after_ms(199);
    expect_nothing(push(kAhead));
}

TEST_F(RexLinkTest, DeadlinesAreTold) {
    EXPECT_FALSE(link_.next_deadline_ns());
    const Question first = asked();
    EXPECT_EQ(link_.next_deadline_ns(), now_ns_ + 100 * kMs);
    now_ns_ += 10 * kMs;
    say(ok_to(first));
    EXPECT_EQ(link_.next_deadline_ns(), now_ns_ + 150 * kMs);
    const Question second = after_ms(150).question.value_or(Question{});
    EXPECT_EQ(link_.next_deadline_ns(), now_ns_ + 100 * kMs);
    say(ok_to(second));
    EXPECT_EQ(link_.next_deadline_ns(), now_ns_ + 10'000 * kMs);
}

TEST(RexLinkConfigTest, LimitsMayOnlyTighten) {
    EXPECT_EQ(RexLinkConfig{}.problem(), std::nullopt);
    using Member = std::int64_t RexLinkConfig::*;
    struct Case {
        Member member;
        std::int64_t least_ns, most_ns;
        const char* name;
    };
    const Case cases[] = {
        {&RexLinkConfig::answer_timeout_ns, 1, 100 * kMs, "answer_timeout_ns"},
        {&RexLinkConfig::second_question_delay_ns, 1, 300 * kMs, "second_question_delay_ns"},
        {&RexLinkConfig::rest_pause_ns, 0, 60'000 * kMs, "rest_pause_ns"},
        {&RexLinkConfig::step_duration_ns, 1, 60'000 * kMs, "step_duration_ns"},
        {&RexLinkConfig::max_valid_for_ns, 150 * kMs, 300 * kMs, "second_question_delay_ns"}};
    for (const Case& c : cases) {
        RexLinkConfig config;
        config.*c.member = c.least_ns;
        EXPECT_EQ(config.problem(), std::nullopt) << c.name;
        config.*c.member = c.most_ns;
        EXPECT_EQ(config.problem(), std::nullopt) << c.name;
        config.*c.member = c.least_ns - 1;
        ASSERT_TRUE(config.problem()) << c.name;
        EXPECT_TRUE(config.problem()->starts_with(c.name)) << *config.problem();
        config.*c.member = c.most_ns + 1;
        EXPECT_TRUE(config.problem()) << c.name;
    }
    RexLinkConfig config;
    config.max_valid_for_ns = 0;
    config.second_question_delay_ns = 0;
    EXPECT_TRUE(config.problem().value_or("").starts_with("max_valid_for_ns"));
}

TEST(RexLinkNames, EveryToneAndReasonHasOne) {
    EXPECT_STREQ(to_string(AnswerVerdict::ok), "OK");
    EXPECT_STREQ(to_string(AnswerVerdict::not_traversable), "NOT_TRAVERSABLE");
    EXPECT_STREQ(to_string(AnswerVerdict::error), "ERROR");
    EXPECT_STREQ(to_string(static_cast<AnswerVerdict>(77)), "ERROR");
    EXPECT_STREQ(to_string(Tone::acknowledge), "acknowledge");
    EXPECT_STREQ(to_string(Tone::not_traversable), "not_traversable");
    EXPECT_STREQ(to_string(Tone::cannot_judge), "cannot_judge");
    const char* const reasons[] = {"not_traversable",
                                   "gate_error",
                                   "silence",
                                   "mismatch",
                                   "damaged",
                                   "expired",
                                   "disconnected",
                                   "clock",
                                   "unknown_code"};
    for (int i = 0; i < 9; ++i) EXPECT_STREQ(to_string(static_cast<Inhibit>(i)), reasons[i]);
}

}  // namespace
}  // namespace surefoot::rex_link
