// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/rosbridge_session.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/arguments.hpp"
#include "service/gate_process/protocol/catalogue.hpp"
#include "service/gate_process/protocol/rosapi.hpp"
#include "service/gate_process/protocol/topic_json.hpp"
#include "service/gate_process/protocol/verdict_json.hpp"

namespace surefoot::gate_process {
namespace {

/// Command of `step_forward`: the outer ring of the joystick, straight ahead (machines/rex.yaml:
/// N).
constexpr std::uint8_t kForwardCode = 9;

/// Returns the id of a message if it is text or an integer, else null.
Json id_of(const Json& message) {
    const auto id = message.find("id");
    if (id == message.end() || !(id->is_string() || id->is_number_integer())) return nullptr;
    return *id;
}

/// Returns the arguments of a call. Clients omit the arguments or send null if there are none.
const Json& args_of(const Json& message) {
    static const Json empty = Json::object();
    const auto args = message.find("args");
    return args == message.end() || args->is_null() ? empty : *args;
}

/// Returns an integer of at least 0, limited to `most`; empty if it is invalid. A missing value or
/// null counts as 0.
std::optional<std::int64_t> limited_member(const Json& message, const char* name, int most) {
    const auto value = message.find(name);
    if (value == message.end() || value->is_null()) return 0;
    if (!value->is_number_unsigned()) return std::nullopt;
    return static_cast<std::int64_t>(
        std::min(value->get<std::uint64_t>(), static_cast<std::uint64_t>(most)));
}

TopicMessage topic_message(Topic topic, const Json& body) {
    return {topic, std::make_shared<const std::string>(dump(body))};
}

}  // namespace

/// The state while one message is handled.
struct RosbridgeSession::Call {
    const Json& message;
    std::int64_t now_ns;
    bool overloaded;
    Reaction& out;
};

RosbridgeSession::RosbridgeSession(std::uint64_t connection,
                                   StepGate& gate,
                                   const SessionLimits& limits,
                                   const SessionRights& rights)
    : connection_(connection),
      gate_(gate),
      limits_(limits),
      messages_(limits.messages),
      refusals_(limits.refusals),
      faults_(limits.faults),
      subscriptions_(limits.max_subscriptions),
      role_(rights.role),
      access_(rights.access) {}

RosbridgeSession::~RosbridgeSession() {
    gate_.forget(connection_);
}

Reaction RosbridgeSession::on_message(std::string_view text, std::int64_t now_ns) {
    Reaction reaction;
    const bool overloaded = !messages_.take(now_ns);
    if (overloaded && !refusals_.take(now_ns)) reaction.drop = true;
    const auto message = parse_json(text, limits_.json);
    const Json nothing = Json::object();
    const Call call{message ? *message : nothing, now_ns, overloaded, reaction};
    if (!message) {
        fault(call, message.error().message);
    } else if (!message->is_object() || text_member(*message, "op").empty()) {
        fault(call, "a message must be an object with a member 'op'");
    } else {
        handle(call);
    }
    return reaction;
}

std::vector<std::string> RosbridgeSession::on_topic(const TopicMessage& message,
                                                    std::int64_t now_ns) {
    return subscriptions_.offer(message, now_ns);
}

std::vector<std::string> RosbridgeSession::due(std::int64_t now_ns) {
    return subscriptions_.due(now_ns);
}

void RosbridgeSession::handle(const Call& call) {
    const std::string op = text_member(call.message, "op");
    if (op == "call_service") return call_service(call);
    if (call.overloaded)
        return status(
            call,
            Level::error,
            "too many messages in a second: the request was not executed; send fewer messages");
    if (op == "subscribe") return subscribe(call);
    if (op == "unsubscribe") return unsubscribe(call);
    if (op == "advertise") return advertise(call);
    if (op == "publish") return publish(call);
    if (op == "set_level") return set_level(call);
    if (op == "unadvertise" || op == "status") return;  // accepted and ignored
    if (op == "auth") return auth(call);
    status(call, Level::error, "the gate does not support the op '" + op + "'");
}

void RosbridgeSession::status(const Call& call, Level level, const std::string& text) const {
    if (level > level_) return;
    const Json id = id_of(call.message);
    const char* const name = level == Level::error     ? "error"
                             : level == Level::warning ? "warning"
                                                       : "info";
    Json message = {{"op", "status"}, {"level", name}};
    message["msg"] = text;
    if (!id.is_null()) message["id"] = id;
    call.out.replies.push_back(dump(message));
}

void RosbridgeSession::fault(const Call& call, const std::string& text) {
    status(call, Level::error, text);
    if (!faults_.take(call.now_ns)) call.out.drop = true;
}

void RosbridgeSession::respond(const Call& call, const Json& values, bool result) const {
    Json response = {{"op", "service_response"}};
    const Json id = id_of(call.message);
    if (!id.is_null()) response["id"] = id;
    response["service"] = text_member(call.message, "service");
    response["values"] = values;
    response["result"] = result;
    call.out.replies.push_back(dump(response));
}

void RosbridgeSession::subscribe(const Call& call) {
    constexpr int kMaxThrottleMs = 60'000;
    constexpr int kMaxQueue = 100;
    constexpr std::int64_t kNsPerMs = 1'000'000;
    const std::string name = text_member(call.message, "topic");
    const std::string type = text_member(call.message, "type");
    const TopicEntry* entry = find_topic(name);
    if (entry == nullptr || entry->from_client)
        return status(
            call, Level::error, "there is no topic '" + name + "' that a client can subscribe to");
    if (!type.empty() && type != "*" && !same_type(entry->type, type)) {
        return status(
            call, Level::error, "topic '" + name + "' is of type " + std::string(entry->type));
    }
    const auto throttle_ms = limited_member(call.message, "throttle_rate", kMaxThrottleMs);
    const auto queue_length = limited_member(call.message, "queue_length", kMaxQueue);
    if (!throttle_ms || !queue_length)
        return status(call,
                      Level::error,
                      "throttle_rate and queue_length must be whole numbers of at least 0");
    const std::string compression = text_member(call.message, "compression");
    if (!compression.empty() && compression != "none")
        status(call,
               Level::warning,
               "compression '" + compression + "' is unknown: messages are sent as plain JSON");
    const auto added =
        subscriptions_.add(entry->topic,
                           name,
                           {.id = text_member(call.message, "id"),
                            .interval_ns = *throttle_ms * kNsPerMs,
                            .queue_length = static_cast<std::size_t>(*queue_length)});
    if (!added) status(call, Level::error, added.error().message);
}

void RosbridgeSession::unsubscribe(const Call& call) {
    const std::string name = text_member(call.message, "topic");
    const TopicEntry* entry = find_topic(name);
    if (entry == nullptr || !subscriptions_.remove(entry->topic, text_member(call.message, "id")))
        status(call, Level::warning, "this client has no subscription to '" + name + "'");
}

void RosbridgeSession::advertise(const Call& call) {
    const std::string name = text_member(call.message, "topic");
    const TopicEntry* entry = find_topic(name);
    if (entry == nullptr || !entry->from_client)
        return status(
            call, Level::error, "there is no topic '" + name + "' that a client can publish to");
    if (!same_type(entry->type, text_member(call.message, "type"))) {
        status(call, Level::error, "topic '" + name + "' is of type " + std::string(entry->type));
    }
}

void RosbridgeSession::publish(const Call& call) {
    const std::string name = text_member(call.message, "topic");
    const TopicEntry* entry = find_topic(name);
    if (entry == nullptr || !entry->from_client)
        return status(
            call, Level::error, "there is no topic '" + name + "' that a client can publish to");
    if (!has_right(call, Role::rider, ActKind::ask))
        return status(call, Level::error, no_right_text(Role::rider));
    judge_goal(call);
}

void RosbridgeSession::judge_goal(const Call& call) {
    const auto message = call.message.find("msg");
    auto goal = read_goal(message == call.message.end() ? Json() : *message);
    if (!goal) {
        status(call, Level::error, goal.error().message);
        for (const Json& marker : no_goal_markers())
            call.out.published.push_back(topic_message(Topic::goal_marker, marker));
        return;
    }
    goal->connection = connection_;
    const Answer answer = gate_.ask_goal(*goal, call.now_ns);
    for (const Json& marker : goal_markers(*goal, answer))
        call.out.published.push_back(topic_message(Topic::goal_marker, marker));
}

void RosbridgeSession::set_level(const Call& call) {
    const std::string level = text_member(call.message, "level");
    if (level == "none") {
        level_ = Level::none;
    } else if (level == "error") {
        level_ = Level::error;
    } else if (level == "warning") {
        level_ = Level::warning;
    } else if (level == "info") {
        level_ = Level::info;
    } else {
        status(call, Level::error, "set_level: give none, error, warning or info");
    }
}

void RosbridgeSession::call_service(const Call& call) {
    const std::string name = text_member(call.message, "service");
    const ServiceEntry* entry = find_service(name);
    if (entry == nullptr) return respond(call, "no service '" + name + "'", false);
    serve(*entry, call, args_of(call.message));
}

void RosbridgeSession::serve(const ServiceEntry& entry, const Call& call, const Json& args) {
    switch (entry.service) {
        case Service::step:
        case Service::step_forward:
        case Service::step_with_reasons: return serve_step(entry, call, args);
        default: break;
    }
    if (call.overloaded)
        return respond(
            call,
            "too many messages in a second: the request was not executed; send fewer messages",
            false);
    switch (entry.service) {
        case Service::authenticate: return authenticate_by_service(call, args);
        case Service::rearm: return rearm(call);
        case Service::attest: return attest(call, args);
        case Service::health: return respond(call, health_object(gate_.report(call.now_ns)), true);
        default: return respond(call, rosapi_answer(entry.service, args), true);
    }
}

void RosbridgeSession::serve_step(const ServiceEntry& entry, const Call& call, const Json& args) {
    if (!has_right(call, Role::rider, ActKind::ask))
        return respond(call, no_right_text(Role::rider), false);
    StepRequest request;
    if (entry.service == Service::step_forward) {
        request.command = kForwardCode;
    } else {
        request = read_step_request(args);
    }
    const bool readable = request.problem == gate::Reason::none;
    const Answer answer = answer_to(request, call);
    const int code = result_code(answer.verdict);
    const Json verdict = verdict_object(answer.verdict, answer.text);
    switch (entry.service) {
        case Service::step_with_reasons: respond(call, verdict, readable); break;
        // The service type Empty has no member, so its clients read only `result`.
        case Service::step_forward: respond(call, {{"resultCode", code}}, code == 0); break;
        default: respond(call, {{"resultCode", code}}, readable);
    }
    // Verdicts on messages that came too fast are not published. Otherwise one flooding client
    // would flood all clients.
    if (!call.overloaded) call.out.published.push_back(topic_message(Topic::verdict, verdict));
}

Answer RosbridgeSession::answer_to(const StepRequest& request, const Call& call) {
    StepQuestion question{connection_, request.sequence.value_or(0), request.command};
    if (call.overloaded)
        return refusal(call, question, gate::Reason::overload, "too many questions at a time");
    if (request.problem != gate::Reason::none)
        return refusal(call, question, request.problem, request.text);
    question.sequence = request.sequence.value_or(last_sequence_ + 1);
    if (question.sequence > kMaxExact)
        return refusal(call,
                       question,
                       gate::Reason::seq,
                       "all sequence numbers of this connection are used: reconnect");
    last_sequence_ = std::max(last_sequence_, question.sequence);
    return ask(call, question);
}

/// Returns the gate's answer. An answer to another question or an expired OK becomes an ERROR.
Answer RosbridgeSession::ask(const Call& call, const StepQuestion& question) {
    Answer answer = gate_.ask_step(question, call.now_ns);
    const gate::Verdict& verdict = answer.verdict;
    if (verdict.connection != question.connection || verdict.sequence != question.sequence ||
        verdict.command != question.command) {
        return refusal(call,
                       question,
                       gate::Reason::internal,
                       "the gate answered another question; ask again");
    }
    if (verdict.decision == gate::Decision::ok && !verdict.allows_step(call.now_ns))
        return refusal(call, question, gate::Reason::expired, "the answer has expired");
    return answer;
}

Answer RosbridgeSession::refusal(const Call& call,
                                 const StepQuestion& question,
                                 gate::Reason reason,
                                 std::string text) {
    Answer answer;
    answer.verdict.reasons = gate::ReasonSet(reason);
    answer.verdict.primary = reason;
    answer.verdict.command = question.command;
    answer.verdict.connection = question.connection;
    answer.verdict.sequence = question.sequence;
    answer.verdict.decided_ns = call.now_ns;
    answer.verdict.valid_until_ns = call.now_ns;
    answer.text = std::move(text);
    return answer;
}

void RosbridgeSession::rearm(const Call& call) {
    if (!has_right(call, Role::operator_, ActKind::rearm))
        return respond_done(call, usage_error(no_right_text(Role::operator_)));
    const Status done = gate_.rearm(connection_, call.now_ns);
    gate_.note(act_of(ActKind::rearm, role_, connection_, done, call.now_ns));
    respond_done(call, done);
}

void RosbridgeSession::attest(const Call& call, const Json& args) {
    if (!has_right(call, Role::operator_, ActKind::attest))
        return respond_done(call, usage_error(no_right_text(Role::operator_)));
    const auto radius_m = read_radius(args);
    if (!radius_m) return respond(call, radius_m.error().message, false);
    const Status done = gate_.attest(connection_, *radius_m, call.now_ns);
    gate_.note(act_of(ActKind::attest, role_, connection_, done, call.now_ns, *radius_m));
    respond_done(call, done);
}

bool RosbridgeSession::has_right(const Call& call, Role least, ActKind kind) {
    if (role_ >= least) return true;
    Act act;
    act.kind = kind;
    act.role = role_;
    act.connection = connection_;
    act.time_ns = call.now_ns;
    gate_.note(act);
    return false;
}

std::string RosbridgeSession::no_right_text(Role least) const {
    return std::string("not done: this needs the role ") + to_string(least) +
           ", and this client is " + to_string(role_) +
           R"(. Connect with ?token=TOKEN, or send {"op":"auth","token":"TOKEN"}; the token is )"
           "in the service's token file";
}

/// The method of roslib for this op calls its first argument `mac`.
void RosbridgeSession::auth(const Call& call) {
    std::string token = text_member(call.message, "token");
    if (token.empty()) token = text_member(call.message, "mac");
    const Status done = authenticate(call, token);
    if (!done) return fault(call, done.error().message);
    status(call, Level::info, std::string("this client is ") + to_string(role_) + " now");
}

void RosbridgeSession::authenticate_by_service(const Call& call, const Json& args) {
    const Status done = authenticate(call, text_argument(args, "token"));
    if (!done && !faults_.take(call.now_ns)) call.out.drop = true;
    respond(call,
            {{"success", done.ok()},
             {"message", done ? "" : done.error().message},
             {"role", to_string(role_)}},
            true);
}

Status RosbridgeSession::authenticate(const Call& call, std::string_view token) {
    const auto role = access_ == nullptr ? std::nullopt : access_->role_of(token);
    Act act = act_of(ActKind::authenticate, role.value_or(role_), connection_, {}, call.now_ns);
    if (!role) act.outcome = ActOutcome::no_right;
    gate_.note(act);
    if (!role)
        return usage_error(
            "this token is not known here, and nothing was changed. Take a token from the "
            "service's token file");
    role_ = *role;
    return {};
}

void RosbridgeSession::respond_done(const Call& call, const Status& done) const {
    respond(call, {{"success", done.ok()}, {"message", done ? "" : done.error().message}}, true);
}

}  // namespace surefoot::gate_process
