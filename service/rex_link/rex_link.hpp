// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <string>

namespace surefoot::rex_link {

/// Times of the REX master unit. problem() rejects an `answer_timeout_ns` or `max_valid_for_ns`
/// above the default.
struct RexLinkConfig {
    std::int64_t answer_timeout_ns = 100'000'000;  ///< longest wait for an answer; then inhibits
    std::int64_t second_question_delay_ns = 150'000'000;  ///< wait after the acknowledgement tone
    /// Time at rest after which the joystick may ask again about a refused code.
    std::int64_t rest_pause_ns = 200'000'000;
    /// Longest validity of a verdict (docs/evidence/safety.md).
    std::int64_t max_valid_for_ns = 300'000'000;
    std::int64_t step_duration_ns = 10'000'000'000;  ///< one movement of 0.35 m at 0.0347 m/s

    /// Returns the first invalid value, as a sentence; empty if all values are valid.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// A question to the gate: "May I make this movement now?"
struct Question {
    std::uint64_t sequence = 0;  ///< increases with every question, even on a new connection
    std::uint8_t command = 0;    ///< joystick code
};

/// The gate's verdict. Damaged bytes may produce any value of the underlying type, so code must
/// handle all values.
enum class AnswerVerdict : std::uint8_t { error = 0, not_traversable = 1, ok = 2 };
/// Returns "OK", "NOT_TRAVERSABLE" or "ERROR"; "ERROR" also for any other value.
[[nodiscard]] const char* to_string(AnswerVerdict verdict) noexcept;

/// A parsed answer. RexLink checks whether the answer belongs to the current question.
struct Answer {
    std::uint64_t nonce = 0;       ///< the session's nonce, returned by the gate
    std::uint64_t connection = 0;  ///< the gate's own number of the connection, never 0
    std::uint64_t sequence = 0;    ///< sequence number of the question
    std::uint8_t command = 0;      ///< command of the question
    AnswerVerdict verdict = AnswerVerdict::error;
    /// Validity set by the gate, counted from the sending of the question.
    std::int64_t valid_for_ns = 0;
};

enum class Tone : std::uint8_t { acknowledge, not_traversable, cannot_judge };
inline constexpr int kToneCount = 3;
/// Returns the name of the tone, for example "acknowledge". Audio file: this name with ".wav".
[[nodiscard]] const char* to_string(Tone tone) noexcept;

/// The reason why a requested movement does not take place.
enum class Inhibit : std::uint8_t {
    not_traversable,  ///< the gate answered NOT_TRAVERSABLE
    gate_error,       ///< the gate answered ERROR or an unknown verdict
    silence,          ///< no answer in time
    mismatch,         ///< an answer to another question or of another session
    damaged,          ///< invalid answer, or a validity above the limit
    expired,          ///< the OK arrived, or would be used, after its validity
    disconnected,     ///< there is no connection, or it is a new connection
    clock,            ///< time went backwards
    unknown_code,     ///< the joystick's code is not a movement
};
/// Returns the name of the reason, for example "not_traversable".
[[nodiscard]] const char* to_string(Inhibit inhibit) noexcept;

/// A motion of the machine: the movement's joystick code and its duration.
struct Motion {
    std::uint8_t command = 0;
    std::int64_t duration_ns = 0;
};

/// Tells the caller what to do now. No action ends a motion: a step in progress is never stopped.
struct Actions {
    std::optional<Question> question;  ///< question to send at once
    std::optional<Tone> tone;          ///< tone to play; do not wait for its end
    std::optional<Motion> motion;      ///< motion to start now
    std::optional<Inhibit> inhibit;    ///< reason of the warning tone, for logs and displays
};

enum class LinkState : std::uint8_t {
    idle,             ///< the joystick is at rest, or at a refused code
    first_question,   ///< first question sent, no answer yet
    acknowledged,     ///< first OK received; the second question waits
    second_question,  ///< second question sent, no answer yet
    stepping,         ///< a motion is in progress
};

/// State machine of the REX master unit. It takes the joystick's code, asks the gate twice, and
/// lets the machine move only after the second OK. It ignores late answers to earlier attempts.
/// Everything else inhibits: a negative verdict, no answer in time, an answer to an unknown
/// question, damaged bytes, an expired OK, a new connection. The link asks about a refused code
/// again only after the joystick was at rest. Every step needs two new OKs.
///
/// Each event is a call with the steady clock's `now_ns`. The link reads no clock, sends nothing
/// and owns no thread. If the time goes backwards, the current attempt is inhibited. Not
/// thread-safe.
class RexLink {
  public:
    /// Precondition: `config.problem()` is empty.
    explicit RexLink(const RexLinkConfig& config);

    /// Notes a new connection. `nonce` is a random number for this session; valid answers must
    /// contain the same number.
    [[nodiscard]] Actions connected(std::uint64_t nonce, std::int64_t now_ns);
    /// Notes the end of the connection. Inhibits a running attempt; a step in progress goes on.
    [[nodiscard]] Actions disconnected(std::int64_t now_ns);
    /// Takes the joystick's code; 0 = at rest. A new code ends an attempt; the same code does not.
    [[nodiscard]] Actions joystick(std::uint8_t code, std::int64_t now_ns);
    /// Takes an answer. The answer has an effect only while an attempt is in progress.
    [[nodiscard]] Actions answer(const Answer& answer, std::int64_t now_ns);
    /// Notes bytes that are not a valid answer.
    [[nodiscard]] Actions damaged_answer(std::int64_t now_ns);
    /// Notes the passing of time. Call it at next_deadline_ns() at the latest; a later call can
    /// only inhibit more.
    [[nodiscard]] Actions tick(std::int64_t now_ns);

    /// Returns the time of the link's next own action. Empty while the link waits for the joystick.
    [[nodiscard]] std::optional<std::int64_t> next_deadline_ns() const noexcept;
    [[nodiscard]] LinkState state() const noexcept { return state_; }

  private:
    /// One attempt at a movement, from the first question on.
    struct Attempt {
        Question question;  ///< the last question sent
        /// Sequence number of the first question; answers to it also belong to the attempt.
        std::uint64_t first_sequence = 0;
        std::int64_t sent_ns = 0;          ///< time at which `question` was sent
        std::uint64_t connection = 0;      ///< connection of the first OK; 0 = no OK yet
        std::int64_t acknowledged_ns = 0;  ///< time at which the first OK arrived
        std::int64_t first_valid_ns = 0;   ///< end of the first OK's validity
    };

    [[nodiscard]] bool attempting() const noexcept;
    [[nodiscard]] bool asking() const noexcept;
    void begin(std::int64_t now_ns, Actions& actions);
    void ask(LinkState state, std::int64_t now_ns, Actions& actions);
    void accept(const Answer& answer, std::int64_t now_ns, Actions& actions);
    void inhibit(Inhibit why, Actions& actions);
    void fall_due(std::int64_t now_ns, Actions& actions);
    template <typename Meaning>
    [[nodiscard]] Actions event(std::int64_t now_ns, const Meaning& meaning);
    void note_time(std::int64_t now_ns, Actions& actions);
    [[nodiscard]] bool fits(const Answer& answer) const noexcept;

    RexLinkConfig config_;
    LinkState state_ = LinkState::idle;
    Attempt attempt_;
    std::uint64_t last_sequence_ = 0;
    std::optional<std::uint64_t> nonce_;  ///< nonce of the session; empty = not connected
    std::uint8_t code_ = 0;               ///< joystick
    std::int64_t rest_since_ns_ = 0;
    std::bitset<256> refused_;  ///< codes not asked again until the joystick was at rest
    std::int64_t motion_end_ns_ = 0;
    std::int64_t last_ns_ = 0;
};

}  // namespace surefoot::rex_link
