// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/gate_process/protocol/subscriptions.hpp"
#include "service/gate_process/sockets/access.hpp"
#include "service/gate_process/sockets/token_bucket.hpp"
#include "service/gate_process/step_gate.hpp"

namespace surefoot::gate_process {

struct ServiceEntry;
struct StepRequest;

/// What one connection may do.
struct SessionLimits {
    JsonLimits json;
    RateLimit messages{200, 200};  ///< beyond it a question is answered ERROR / OVERLOAD
    RateLimit refusals{100, 400};  ///< messages beyond that rate, before the connection is dropped
    RateLimit faults{2, 20};       ///< messages that cannot be read, before it is dropped
    std::size_t max_subscriptions = 32;
};

/// What the client of a session may do.
struct SessionRights {
    Role role = Role::none;          ///< at the beginning
    const Access* access = nullptr;  ///< tokens that may change it; nullptr: none can. Lives on
};

/// What a message brought about.
struct Reaction {
    std::vector<std::string> replies;     ///< to this connection, before everything else
    std::vector<TopicMessage> published;  ///< to the subscribers of all connections
    bool drop = false;                    ///< the client had its chances
};

/// One client of the rosbridge protocol, version 2: a text in, texts out. No socket, no clock, no
/// thread. Every question about a step goes to the gate exactly once, and nothing but the gate's
/// own OK to this connection and sequence is answered as one; what cannot be read or comes too fast
/// is an ERROR. Texts that are no JSON, or no message, get a status and change nothing. What the
/// role of the client does not allow is refused with a sentence, noted for the audit log, and never
/// reaches the gate.
class RosbridgeSession {
  public:
    /// `connection` is never 0 and never used again. The gate outlives the session.
    RosbridgeSession(std::uint64_t connection,
                     StepGate& gate,
                     const SessionLimits& limits,
                     const SessionRights& rights);
    RosbridgeSession(const RosbridgeSession&) = delete;
    RosbridgeSession& operator=(const RosbridgeSession&) = delete;
    /// The gate forgets the connection.
    ~RosbridgeSession();

    [[nodiscard]] Reaction on_message(std::string_view text, std::int64_t now_ns);
    /// What this client gets of a topic's message now. Cheap where it did not subscribe.
    [[nodiscard]] std::vector<std::string> on_topic(const TopicMessage& message,
                                                    std::int64_t now_ns);
    /// Messages whose throttle time has passed. Call it every few milliseconds.
    [[nodiscard]] std::vector<std::string> due(std::int64_t now_ns);

    [[nodiscard]] bool wants(Topic topic) const noexcept { return subscriptions_.wants(topic); }
    [[nodiscard]] bool wants_any() const noexcept { return subscriptions_.count() > 0; }
    [[nodiscard]] std::uint64_t connection() const noexcept { return connection_; }
    [[nodiscard]] Role role() const noexcept { return role_; }

  private:
    enum class Level : std::uint8_t { none, error, warning, info };
    struct Call;

    void handle(const Call& call);
    void status(const Call& call, Level level, const std::string& text) const;
    void respond(const Call& call, const Json& values, bool result) const;
    void fault(const Call& call, const std::string& text);

    void subscribe(const Call& call);
    void unsubscribe(const Call& call);
    void advertise(const Call& call);
    void publish(const Call& call);
    void set_level(const Call& call);
    void judge_goal(const Call& call);
    void auth(const Call& call);
    [[nodiscard]] Status authenticate(const Call& call, std::string_view token);
    /// False, and noted, when the role of the client is below `least`.
    [[nodiscard]] bool has_right(const Call& call, Role least, ActKind kind);
    [[nodiscard]] std::string no_right_text(Role least) const;

    void call_service(const Call& call);
    void serve(const ServiceEntry& entry, const Call& call, const Json& args);
    void serve_step(const ServiceEntry& entry, const Call& call, const Json& args);
    [[nodiscard]] Answer answer_to(const StepRequest& request, const Call& call);
    void rearm(const Call& call);
    void authenticate_by_service(const Call& call, const Json& args);
    void attest(const Call& call, const Json& args);
    void respond_done(const Call& call, const Status& done) const;

    [[nodiscard]] Answer ask(const Call& call, const StepQuestion& question);
    [[nodiscard]] static Answer refusal(const Call& call,
                                        const StepQuestion& question,
                                        gate::Reason reason,
                                        std::string text);

    std::uint64_t connection_;
    StepGate& gate_;
    SessionLimits limits_;
    TokenBucket messages_;
    TokenBucket refusals_;
    TokenBucket faults_;
    Subscriptions subscriptions_;
    Role role_;
    const Access* access_;
    Level level_ = Level::warning;
    std::uint64_t last_sequence_ = 0;
};

}  // namespace surefoot::gate_process
