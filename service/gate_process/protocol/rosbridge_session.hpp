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

/// Limits of one connection.
struct SessionLimits {
    JsonLimits json;
    RateLimit messages{200, 200};  ///< a question beyond this rate gets ERROR / OVERLOAD
    RateLimit refusals{100, 400};  ///< excess messages; beyond this rate the client is disconnected
    RateLimit faults{2, 20};       ///< faulty messages; beyond this rate the client is disconnected
    std::size_t max_subscriptions = 32;
};

/// Permissions of the client of a session.
struct SessionRights {
    Role role = Role::none;          ///< role at the start
    const Access* access = nullptr;  ///< tokens of the roles, or nullptr; must outlive the session
};

/// The effects of one received message.
struct Reaction {
    std::vector<std::string> replies;     ///< texts to this connection, sent before all other texts
    std::vector<TopicMessage> published;  ///< messages to the subscribers of all connections
    bool drop = false;                    ///< disconnect: the client exceeded its limits
};

/// The server side of one rosbridge client (protocol version 2). Turns a text into texts; has no
/// socket, clock or thread. A valid step question within the rate limit reaches the gate exactly
/// once. Unreadable or too frequent questions get ERROR. Only the gate's own OK to this connection
/// and sequence is returned as OK. Text that is not JSON or not a message gets a status and has no
/// effect. A request beyond the client's role is refused with a message, logged, and never
/// reaches the gate.
class RosbridgeSession {
  public:
    /// `connection` is never 0 and never reused. The gate must outlive the session.
    RosbridgeSession(std::uint64_t connection,
                     StepGate& gate,
                     const SessionLimits& limits,
                     const SessionRights& rights);
    RosbridgeSession(const RosbridgeSession&) = delete;
    RosbridgeSession& operator=(const RosbridgeSession&) = delete;
    /// Makes the gate forget the connection.
    ~RosbridgeSession();

    [[nodiscard]] Reaction on_message(std::string_view text, std::int64_t now_ns);
    /// Returns the texts for this client from a topic message. Cheap without a subscription.
    [[nodiscard]] std::vector<std::string> on_topic(const TopicMessage& message,
                                                    std::int64_t now_ns);
    /// Returns messages whose throttle time has passed. Call it every few milliseconds.
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
    /// Returns false if the client's role is below `least`, and notes the refusal in the audit log.
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
