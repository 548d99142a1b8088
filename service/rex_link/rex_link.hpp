// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <string>

namespace surefoot::rex_link {

/// Times of the REX master unit. What is safe to tighten may be tightened, and nothing loosened.
struct RexLinkConfig {
    std::int64_t answer_timeout_ns = 100'000'000;  ///< silence after a question that inhibits
    std::int64_t second_question_delay_ns = 150'000'000;  ///< after the acknowledgement tone
    std::int64_t rest_pause_ns = 200'000'000;  ///< joystick at rest before a refused code is asked
    std::int64_t max_valid_for_ns = 300'000'000;     ///< no verdict lives longer: safety.md, 7
    std::int64_t step_duration_ns = 10'000'000'000;  ///< of one movement: 0.35 m at 0.0347 m/s

    /// First reason why these times cannot be used, in words.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// "May I make this movement now?" of the connection that the question goes out on.
struct Question {
    std::uint64_t sequence = 0;  ///< grows with every question, over all connections
    std::uint8_t command = 0;    ///< joystick code
};

/// What the gate said. Every value may come: bytes that were damaged on the way make one, too.
enum class AnswerVerdict : std::uint8_t { error = 0, not_traversable = 1, ok = 2 };
/// "OK", "NOT_TRAVERSABLE", "ERROR", the last one for what is none of the three.
[[nodiscard]] const char* to_string(AnswerVerdict verdict) noexcept;

/// An answer as its bytes tell it, whatever it answers.
struct Answer {
    std::uint64_t nonce = 0;       ///< of the link's session, as it came back
    std::uint64_t connection = 0;  ///< the gate's own name of the connection, never 0
    std::uint64_t sequence = 0;    ///< of the question
    std::uint8_t command = 0;      ///< of the question
    AnswerVerdict verdict = AnswerVerdict::error;
    std::int64_t valid_for_ns = 0;  ///< the gate's word; it counts from the sending of the question
};

enum class Tone : std::uint8_t { acknowledge, not_traversable, cannot_judge };
inline constexpr int kToneCount = 3;
/// "acknowledge"; its audio file is that and ".wav".
[[nodiscard]] const char* to_string(Tone tone) noexcept;

/// Why a movement that the user asked for does not take place.
enum class Inhibit : std::uint8_t {
    not_traversable,  ///< the gate says so
    gate_error,       ///< the gate says that it cannot judge, or something unknown
    silence,          ///< no answer in time
    mismatch,         ///< an answer to another question, or of another session
    damaged,          ///< bytes that are no answer
    expired,          ///< the OK came, or would be used, after its life
    disconnected,     ///< no connection, or another one
    clock,            ///< time went backwards
    unknown_code,     ///< the joystick sends what is no movement
};
/// "not_traversable".
[[nodiscard]] const char* to_string(Inhibit inhibit) noexcept;

struct Motion {
    std::uint8_t command = 0;
    std::int64_t duration_ns = 0;
};

/// What to do now. There is no action that ends a motion: a step under way is never stopped.
struct Actions {
    std::optional<Question> question;  ///< send it, now
    std::optional<Tone> tone;          ///< play it, without waiting for its end
    std::optional<Motion> motion;      ///< start it
    std::optional<Inhibit> inhibit;    ///< why there was a warning, for whoever reads along
};

enum class LinkState : std::uint8_t {
    idle,             ///< joystick at rest, or at a code that was refused
    first_question,   ///< sent, no answer yet
    acknowledged,     ///< first OK; waits before it asks again
    second_question,  ///< sent, no answer yet
    stepping,         ///< a motion is under way
};

/// The REX master unit: takes what the joystick asks for, asks the gate twice and lets the machine
/// move on the second OK alone. All else inhibits: a no, silence, an answer that fits no question,
/// damage, an OK after its life, another connection. A refused code is asked again after the
/// joystick was at rest. Every step needs two OKs of its own, however long the joystick is held.
///
/// Each event is a call with the steady clock's `now_ns`; the link reads no clock, sends nothing
/// and owns no thread. Times of events should not fall; if they do, that inhibits. Not thread-safe.
class RexLink {
  public:
    explicit RexLink(const RexLinkConfig& config);

    /// A connection stands. `nonce` is the session's own, drawn at random; answers must bring it
    /// back.
    [[nodiscard]] Actions connected(std::uint64_t nonce, std::int64_t now_ns);
    [[nodiscard]] Actions disconnected(std::int64_t now_ns);
    /// The joystick's code; 0 = at rest. Calls that repeat it change nothing.
    [[nodiscard]] Actions joystick(std::uint8_t code, std::int64_t now_ns);
    [[nodiscard]] Actions answer(const Answer& answer, std::int64_t now_ns);
    /// Bytes came that are no answer.
    [[nodiscard]] Actions damaged_answer(std::int64_t now_ns);
    /// Time passed. Call it at `next_deadline_ns` at the latest; later only inhibits more.
    [[nodiscard]] Actions tick(std::int64_t now_ns);

    /// When something falls due by itself; nothing while the link only waits for the user.
    [[nodiscard]] std::optional<std::int64_t> next_deadline_ns() const noexcept;
    [[nodiscard]] LinkState state() const noexcept { return state_; }

  private:
    /// One go at a movement, from the first question on.
    struct Attempt {
        Question question;                 ///< the one that was sent last
        std::uint64_t first_sequence = 0;  ///< its answers belong to the attempt, too
        std::int64_t sent_ns = 0;          ///< the last question
        std::uint64_t connection = 0;      ///< that gave the first OK; 0 = none did
        std::int64_t acknowledged_ns = 0;  ///< first OK
        std::int64_t first_valid_ns = 0;   ///< end of the first OK's life
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
    std::optional<std::uint64_t> nonce_;  ///< of the session; nothing = not connected
    std::uint8_t code_ = 0;               ///< joystick
    std::int64_t rest_since_ns_ = 0;
    std::bitset<256> refused_;  ///< codes that wait for the joystick to rest
    std::int64_t motion_end_ns_ = 0;
    std::int64_t last_ns_ = 0;
};

}  // namespace surefoot::rex_link
