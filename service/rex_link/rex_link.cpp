// SPDX-License-Identifier: Apache-2.0
#include "service/rex_link/rex_link.hpp"

#include "surefoot/core/assert.hpp"
#include "surefoot/core/machine.hpp"

namespace surefoot::rex_link {
namespace {

constexpr std::int64_t kLongestSilence_ns = 100'000'000;
constexpr std::int64_t kLongestLife_ns = 300'000'000;
constexpr std::int64_t kLongest_ns = 60'000'000'000;

}  // namespace

std::optional<std::string> RexLinkConfig::problem() const {
    const auto within = [](std::int64_t value_ns, std::int64_t least_ns, std::int64_t most_ns) {
        return value_ns >= least_ns && value_ns <= most_ns;
    };
    if (!within(answer_timeout_ns, 1, kLongestSilence_ns))
        return "answer_timeout_ns: must be from 1 to 100000000 (100 ms)";
    if (!within(max_valid_for_ns, 1, kLongestLife_ns))
        return "max_valid_for_ns: must be from 1 to 300000000 (300 ms)";
    if (!within(second_question_delay_ns, 1, max_valid_for_ns))
        return "second_question_delay_ns: must be above 0 and at most max_valid_for_ns, the "
               "longest validity of the first OK";
    if (!within(rest_pause_ns, 0, kLongest_ns))
        return "rest_pause_ns: must be from 0 to 60000000000 (60 s)";
    if (!within(step_duration_ns, 1, kLongest_ns))
        return "step_duration_ns: must be from 1 to 60000000000 (60 s)";
    return std::nullopt;
}

const char* to_string(AnswerVerdict verdict) noexcept {
    switch (verdict) {
        case AnswerVerdict::ok: return "OK";
        case AnswerVerdict::not_traversable: return "NOT_TRAVERSABLE";
        case AnswerVerdict::error: return "ERROR";
    }
    return "ERROR";
}

const char* to_string(Tone tone) noexcept {
    switch (tone) {
        case Tone::acknowledge: return "acknowledge";
        case Tone::not_traversable: return "not_traversable";
        case Tone::cannot_judge: return "cannot_judge";
    }
    return "cannot_judge";
}

const char* to_string(Inhibit inhibit) noexcept {
    switch (inhibit) {
        case Inhibit::not_traversable: return "not_traversable";
        case Inhibit::gate_error: return "gate_error";
        case Inhibit::silence: return "silence";
        case Inhibit::mismatch: return "mismatch";
        case Inhibit::damaged: return "damaged";
        case Inhibit::expired: return "expired";
        case Inhibit::disconnected: return "disconnected";
        case Inhibit::clock: return "clock";
        case Inhibit::unknown_code: return "unknown_code";
    }
    return "gate_error";
}

RexLink::RexLink(const RexLinkConfig& config) : config_(config) {
    SUREFOOT_ASSERT(!config.problem());
}

/// Common part of every event: notes the time, handles the event, then handles deadlines that have
/// passed.
template <typename Meaning>
Actions RexLink::event(std::int64_t now_ns, const Meaning& meaning) {
    Actions actions;
    note_time(now_ns, actions);
    meaning(actions);
    fall_due(now_ns, actions);
    return actions;
}

Actions RexLink::connected(std::uint64_t nonce, std::int64_t now_ns) {
    return event(now_ns, [&](Actions& actions) {
        if (attempting()) inhibit(Inhibit::disconnected, actions);
        nonce_ = nonce;
    });
}

Actions RexLink::disconnected(std::int64_t now_ns) {
    return event(now_ns, [&](Actions& actions) {
        if (attempting()) inhibit(Inhibit::disconnected, actions);
        nonce_.reset();
    });
}

Actions RexLink::joystick(std::uint8_t code, std::int64_t now_ns) {
    return event(now_ns, [&](Actions&) {
        if (code == code_) return;
        // if the user changes the joystick, the attempt ends without a warning
        if (attempting()) state_ = LinkState::idle;
        if (code_ == 0 && now_ns - rest_since_ns_ >= config_.rest_pause_ns) refused_.reset();
        if (code == 0) rest_since_ns_ = now_ns;
        code_ = code;
    });
}

Actions RexLink::answer(const Answer& answer, std::int64_t now_ns) {
    return event(now_ns, [&](Actions& actions) {
        if (attempting()) accept(answer, now_ns, actions);
    });
}

Actions RexLink::damaged_answer(std::int64_t now_ns) {
    return event(now_ns, [&](Actions& actions) {
        if (attempting()) inhibit(Inhibit::damaged, actions);
    });
}

Actions RexLink::tick(std::int64_t now_ns) {
    return event(now_ns, [](Actions&) {});
}

std::optional<std::int64_t> RexLink::next_deadline_ns() const noexcept {
    switch (state_) {
        case LinkState::idle: return std::nullopt;
        case LinkState::first_question:
        case LinkState::second_question: return attempt_.sent_ns + config_.answer_timeout_ns;
        case LinkState::acknowledged:
            return attempt_.acknowledged_ns + config_.second_question_delay_ns;
        case LinkState::stepping: return motion_end_ns_;
    }
    return std::nullopt;
}

bool RexLink::attempting() const noexcept {
    return asking() || state_ == LinkState::acknowledged;
}

bool RexLink::asking() const noexcept {
    return state_ == LinkState::first_question || state_ == LinkState::second_question;
}

void RexLink::note_time(std::int64_t now_ns, Actions& actions) {
    const bool backwards = now_ns < last_ns_;
    last_ns_ = now_ns;
    if (!backwards) return;
    rest_since_ns_ = now_ns;  // restarts, because the duration of the rest is unknown
    if (attempting()) inhibit(Inhibit::clock, actions);
}

/// Handles deadlines, and starts an attempt if the joystick asks for a movement.
void RexLink::fall_due(std::int64_t now_ns, Actions& actions) {
    if (state_ == LinkState::stepping && now_ns >= motion_end_ns_) state_ = LinkState::idle;
    if (asking() && now_ns - attempt_.sent_ns >= config_.answer_timeout_ns)
        inhibit(Inhibit::silence, actions);
    if (state_ == LinkState::acknowledged &&
        now_ns - attempt_.acknowledged_ns >= config_.second_question_delay_ns) {
        if (now_ns < attempt_.first_valid_ns) {
            ask(LinkState::second_question, now_ns, actions);
        } else {
            inhibit(Inhibit::expired, actions);
        }
    }
    if (state_ == LinkState::idle && code_ != 0 && !refused_[code_]) begin(now_ns, actions);
}

/// Asks the first question about the joystick's code, or inhibits if it cannot ask.
void RexLink::begin(std::int64_t now_ns, Actions& actions) {
    if (code_ >= Machine::kMovementCodes) {
        inhibit(Inhibit::unknown_code, actions);
    } else if (!nonce_) {
        inhibit(Inhibit::disconnected, actions);
    } else {
        attempt_ = {};
        ask(LinkState::first_question, now_ns, actions);
        attempt_.first_sequence = attempt_.question.sequence;
    }
}

void RexLink::ask(LinkState state, std::int64_t now_ns, Actions& actions) {
    state_ = state;
    attempt_.question = {++last_sequence_, code_};
    attempt_.sent_ns = now_ns;
    actions.question = attempt_.question;
}

/// True if the answer belongs to this session and this attempt, and is about this movement.
bool RexLink::fits(const Answer& answer) const noexcept {
    return answer.nonce == nonce_ && answer.connection != 0 &&
           (attempt_.connection == 0 || answer.connection == attempt_.connection) &&
           answer.sequence <= attempt_.question.sequence &&
           answer.command == attempt_.question.command;
}

/// Applies an answer to the attempt. Late answers to earlier attempts and repeated OKs are ignored.
/// Any other answer inhibits, except a fresh OK to the current question.
void RexLink::accept(const Answer& answer, std::int64_t now_ns, Actions& actions) {
    if (answer.nonce == nonce_ && answer.sequence < attempt_.first_sequence) return;
    if (!fits(answer)) return inhibit(Inhibit::mismatch, actions);
    if (answer.verdict == AnswerVerdict::not_traversable)
        return inhibit(Inhibit::not_traversable, actions);
    if (answer.verdict != AnswerVerdict::ok) return inhibit(Inhibit::gate_error, actions);
    // this OK was already counted
    if (!asking() || answer.sequence != attempt_.question.sequence) return;

    // The validity counts from the time when the question was sent. So a delay of the answer
    // shortens the validity.
    const std::int64_t age_ns = now_ns - attempt_.sent_ns;
    if (age_ns >= config_.answer_timeout_ns) return inhibit(Inhibit::silence, actions);
    if (answer.valid_for_ns > config_.max_valid_for_ns) return inhibit(Inhibit::damaged, actions);
    if (age_ns >= answer.valid_for_ns) return inhibit(Inhibit::expired, actions);
    attempt_.connection = answer.connection;
    if (state_ == LinkState::first_question) {
        state_ = LinkState::acknowledged;
        attempt_.acknowledged_ns = now_ns;
        attempt_.first_valid_ns = attempt_.sent_ns + answer.valid_for_ns;
        actions.tone = Tone::acknowledge;
    } else {
        state_ = LinkState::stepping;
        motion_end_ns_ = now_ns + config_.step_duration_ns;
        actions.motion = Motion{attempt_.question.command, config_.step_duration_ns};
    }
}

void RexLink::inhibit(Inhibit why, Actions& actions) {
    state_ = LinkState::idle;
    refused_.set(code_);
    actions.tone = why == Inhibit::not_traversable ? Tone::not_traversable : Tone::cannot_judge;
    actions.inhibit = why;
}

}  // namespace surefoot::rex_link
