// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace surefoot::wire {

/// Everything that has a name on the wire. Closed: a name that is not here is not served.
enum class Topic : std::uint8_t { verdict, health, diagnostics, outlook, goal_marker, goal };

struct TopicEntry {
    Topic topic;
    std::string_view name;
    std::string_view type;
    bool from_client;  ///< clients publish it; all others are for them to subscribe to
};

inline constexpr std::array<TopicEntry, 6> kTopics{{
    {Topic::verdict, "/surefoot/verdict", "surefoot/Verdict", false},
    {Topic::health, "/surefoot/health", "surefoot/Health", false},
    {Topic::diagnostics, "/diagnostics", "diagnostic_msgs/DiagnosticArray", false},
    {Topic::outlook, "/surefoot/outlook", "surefoot/Outlook", false},
    {Topic::goal_marker, "/surefoot/goal_marker", "visualization_msgs/Marker", false},
    {Topic::goal, "/move_base_simple/goal", "geometry_msgs/PoseStamped", true},
}};

enum class Service : std::uint8_t {
    step,
    step_forward,
    step_with_reasons,
    rearm,
    vouch,
    health,
    list_topics,
    list_services,
    list_nodes,
    topic_type,
    service_type,
    get_param
};

struct ServiceEntry {
    Service service;
    std::string_view name;
    std::string_view type;
};

inline constexpr std::array<ServiceEntry, 12> kServices{{
    {Service::step, "/step", "rex_interface/stepQuery"},
    {Service::step_forward, "/step_forward", "std_srvs/Empty"},
    {Service::step_with_reasons, "/surefoot/step", "surefoot/Step"},
    {Service::rearm, "/surefoot/rearm", "std_srvs/Trigger"},
    {Service::vouch, "/surefoot/vouch", "surefoot/Vouch"},
    {Service::health, "/surefoot/health", "surefoot/GetHealth"},
    {Service::list_topics, "/rosapi/topics", "rosapi/Topics"},
    {Service::list_services, "/rosapi/services", "rosapi/Services"},
    {Service::list_nodes, "/rosapi/nodes", "rosapi/Nodes"},
    {Service::topic_type, "/rosapi/topic_type", "rosapi/TopicType"},
    {Service::service_type, "/rosapi/service_type", "rosapi/ServiceType"},
    {Service::get_param, "/rosapi/get_param", "rosapi/GetParam"},
}};

/// The entry of that name, with or without the leading slash, or nullptr.
[[nodiscard]] const TopicEntry* find_topic(std::string_view name) noexcept;
[[nodiscard]] const ServiceEntry* find_service(std::string_view name) noexcept;

/// Do the two name one type? "pkg/Name" and "pkg/msg/Name" do.
[[nodiscard]] bool same_type(std::string_view ours, std::string_view theirs) noexcept;

}  // namespace surefoot::wire
